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
"$build/bin/softfinger" compare silicone_pad_2mm --set contact.load_N=2 --quiet --output "$folder/report" >/dev/null
"$build/bin/softfinger" select silicone_pad_2mm --tolerance 0.05 --quiet --output "$folder/choice" >/dev/null
picture silicone_pad "$folder/report/report.html#case-silicone_pad_2mm" 1280,1080
picture select_page "$folder/choice/select.html" 1200,1860
