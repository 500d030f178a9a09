#!/usr/bin/env bash
# Makes the pictures of the README and of these pages again, and the numbers behind them (pictures.csv).
#
# usage: docs/pictures.sh [BUILD]     default: build/release; needs Chromium
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
build=$(cd "${1:-$root/build/release}" && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# picture NAME PAGE WIDTH,HEIGHT
picture() {
  chromium --headless --no-sandbox --disable-gpu --hide-scrollbars --virtual-time-budget=5000 \
    --window-size="$3" --screenshot="$root/docs/$1.png" "file://$2" 2>/dev/null
}

python3 "$root/docs/picture_data.py" --build "$build" --write "$root/docs/pictures.csv"
"$build/bin/softfinger" compare silicone_pad_2mm --quiet --output "$folder/report" >/dev/null
"$build/bin/softfinger" select silicone_pad_2mm --tolerance 0.05 --quiet --output "$folder/choice" >/dev/null
# Of the report, one case alone.
sed 's|</head>|<style>body :not(:has(section.case)):not(section.case, section.case *) { display: none } section.case { margin: -3rem 0 0; border: 0 }</style></head>|' \
  "$folder/report/report.html" > "$folder/report/case.html"
picture silicone_pad "$folder/report/case.html" 1280,1120
picture select_page "$folder/choice/select.html" 1200,1860
