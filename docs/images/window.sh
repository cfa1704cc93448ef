#!/bin/sh
# Makes the window's pictures of the documentation: docs/images/window.sh [PROGRAM [FOLDER]]. Needs Xvfb. The pointer stands in a
# corner beyond the window, so that it opens no tooltip.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
program=${1:-$here/../../build/release/bin/clarity}
out=${2:-$here}
scene=$here/../../scenes/showpiece.scene
work=$(mktemp -d)
trap 'kill "$screen" 2>/dev/null || true; rm -rf "$work"' EXIT
Xvfb -displayfd 3 -screen 0 2700x1800x24 -nolisten tcp 3>"$work/display" 2>/dev/null &
screen=$!
until [ -s "$work/display" ]; do sleep 0.1; done
unset WAYLAND_DISPLAY

# shoot WIDTHxHEIGHT TEXT_SCALE PICTURE_SIZE <script: a window of its own, remembering nothing
shoot() {
    cat >"$work/script"
    echo quit >>"$work/script"
    mkdir -p "$work/config/clarity"
    printf '{"width": %s, "height": %s, "text_scale": %s}\n' "${1%x*}" "${1#*x}" "$2" >"$work/config/clarity/window.json"
    DISPLAY=:$(cat "$work/display") XDG_CONFIG_HOME=$work/config CLARITY_UI_SCRIPT=$work/script \
        "$program" view --size "$3" --spp 16 "$scene" >"$work/answers"
    ! grep '^error' "$work/answers"
}

shoot 1280x800 1 856x748 <<COMMANDS
wait idle 300
screenshot $out/window.png
level 3
wait idle
screenshot $out/window_volumes.png
level off
inspect 620 490
tab Inspect
wait idle
wait idle
screenshot $out/window_rays.png
tab Stats
set spp 1
compare b
accel bvh8
set aov steps
wait idle 100
screenshot $out/window_heat.png
COMMANDS

# So high that the rows of a material and its ball are seen. The ball is made while the window rests: each wait takes three frames.
shoot 1280x1300 1 856x1248 <<COMMANDS
wait idle 300
tab Scene
pick 420 650
lights 1
$(yes "wait idle 300" | head -n 300)
screenshot $out/window_scene.png
COMMANDS

shoot 1920x1080 1 1496x1028 <<COMMANDS
set spp 4
compare b
accel spheres
wait idle 300
screenshot $out/window_compare.png
COMMANDS

shoot 1280x800 1.5 640x560 <<COMMANDS
wait idle 300
screenshot $out/window_large_text.png
COMMANDS

# The showpiece with a chest that hovers and turns, and a camera that moves from key to key.
cp -r "$here/../../scenes" "$work/scenes"
scene=$work/scenes/showpiece.scene
cat >>"$scene" <<ANIMATED
animate chest translate  0 -.3 0 -1.8   1 -.3 1.2 -1   2 -.3 0 -1.8
animate chest rotate     0 0 1 0 8   2 0 1 0 368
ANIMATED
shoot 1280x800 1 856x660 <<COMMANDS
wait idle 300
loop 0.25 1.5
time 0.25
wait idle 300
camera_key set
time 1.5
wait idle 300
edit camera 2.2,2.1,5.2,-0.05,1.2,-1,40,0,1,0
camera_key set
time 0.75
wait idle 300
screenshot $out/window_timeline.png
COMMANDS

# Why a pixel in a caustic is noisy.
scene=$work/caustic.scene
cat >"$scene" <<CAUSTIC
background .02 .03 .05
camera main eye 1.2 2.6 6 target 0 .7 0 fov 40
light sphere center 0 6 -2 radius .2 radiance 300 name bulb
material floor model lambert color .7 .68 .62
material clear model dielectric color 1 ior 1.5
material gold model conductor color 1 .77 .34 roughness .25
plane normal 0 1 0 offset 0 material floor
sphere center 0 1.2 -.4 radius 1 material clear
sphere center 2 .6 .2 radius .6 material gold
CAUSTIC
shoot 1280x1000 1 856x748 <<COMMANDS
set tracer path
set spp 256
wait idle 300
tab Inspect
inspect 429 476
wait idle 300
why 429 476
wait idle 300
wait idle 300
screenshot $out/window_noise.png
COMMANDS

# stb writes quickly, not tightly.
if command -v convert >/dev/null; then
    for picture in "$out"/window*.png; do
        convert "$picture" -strip -define png:compression-level=9 -define png:compression-filter=5 "$work/tight.png"
        mv "$work/tight.png" "$picture"
    done
fi
