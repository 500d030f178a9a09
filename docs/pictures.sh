#!/usr/bin/env bash
# Makes the pictures of the README and of these pages again, and the numbers behind them (pictures.csv).
#
# usage: docs/pictures.sh [BUILD]     default: build/release; needs Chromium
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
build=$(cd "${1:-$root/build/release}" && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# picture NAME PAGE [WIDTH,HEIGHT]     PAGE in $folder; the processor draws what is in 3-D
picture() {
  chromium --headless --no-sandbox --use-angle=swiftshader --enable-unsafe-swiftshader --hide-scrollbars \
    --virtual-time-budget=5000 --window-size="${3:-1280,900}" --screenshot="$root/docs/$1.png" "file://$folder/$2" 2>/dev/null
}
softfinger() { (cd "$folder" && "$build/bin/softfinger" "$@" --quiet >/dev/null); }

python3 "$root/docs/picture_data.py" --build "$build" --write "$root/docs/pictures.csv"
softfinger compare silicone_pad_2mm --output report
softfinger select silicone_pad_2mm --tolerance 0.05 --output choice
softfinger sweep thickness_and_load --output sweep
softfinger predict pad_on_plane --page predict.html
softfinger simulate pinch --output motion
softfinger calibrate inked_fingertip.csv silicone_pad_2mm --page calibration.html
softfinger mesh shadow_like_pad.stl --page mesh.html
softfinger explore silicone_pad_2mm --output explore.html
# The case alone, without the head of its report.
sed 's|</head>|<style>body :not(:has(section.case)):not(section.case, section.case *) { display: none } section.case { margin: -3rem 0 0; border: 0 }</style></head>|' \
  "$folder/report/report.html" > "$folder/report/case.html"
picture silicone_pad report/case.html 1280,1120
picture compare_page report/report.html
picture select_page choice/select.html
picture sweep_page sweep/sweep.html
picture predict_page predict.html
picture motion_page 'motion/motion.html#t=0.3'
picture calibrate_page calibration.html
picture mesh_page mesh.html
picture explore_page explore.html
