#!/bin/sh
# Makes the window's pictures of the documentation: docs/images/window.sh [PROGRAM]. Needs Xvfb; the screen is larger than the
# window, so that the pointer in its middle opens no tooltip.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
program=${1:-$here/../../build/release/bin/clarity}
work=$(mktemp -d)
trap 'kill "$screen" 2>/dev/null || true; rm -rf "$work"' EXIT
Xvfb -displayfd 3 -screen 0 2700x1800x24 -nolisten tcp 3>"$work/display" 2>/dev/null &
screen=$!
until [ -s "$work/display" ]; do sleep 0.1; done
cat >"$work/script" <<COMMANDS
wait idle 300
screenshot $here/window.png
level 3
wait idle
screenshot $here/window_volumes.png
wait idle
quit
COMMANDS
unset WAYLAND_DISPLAY
DISPLAY=:$(cat "$work/display") CLARITY_UI_NO_SAVE=1 CLARITY_UI_SCRIPT=$work/script \
    "$program" view --size 884x748 --spp 16 "$here/../../scenes/showpiece.scene"
# stb writes quickly, not tightly.
if command -v convert >/dev/null; then
    for picture in window window_volumes; do
        convert "$here/$picture.png" -strip -define png:compression-level=9 -define png:compression-filter=5 "$work/tight.png"
        mv "$work/tight.png" "$here/$picture.png"
    done
fi
