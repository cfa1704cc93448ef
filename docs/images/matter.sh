#!/bin/sh
# Makes the pictures of docs/matter.md: docs/images/matter.sh PROGRAM ASSETS [NAME...]. ASSETS: a folder with the models of Khronos'
# glTF-Sample-Assets. OUT and OPTIONS in the environment: another folder for the pictures, further options of `render`.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
program=$(realpath "$1") assets=$(realpath "$2") out=$(realpath "${OUT:-$here}")
shift 2
wanted=" $* "

sun=$here/matter.scene
sky=$here/../../scenes/plaster_sky.scene # alone, where suns that are seen through glass would be noise

# Pictures carry the command that made them. It runs in a folder of links, so that it names no folder of this computer.
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

# show NAME MODEL SIZE CAMERA LIGHT [SAMPLES]
show() {
    case $wanted in "  " | *" $1 "*) ;; *) return 0 ;; esac
    model=$2
    [ -e "$model" ] || model=$(find -L "$assets" -name "$2" | head -n 1)
    [ -n "$model" ] || { echo "matter.sh: no $2 in $assets" >&2; exit 1; }
    ln -sfn "$(dirname "$model")" models
    ln -sf "$5" .
    # shellcheck disable=SC2086
    "$program" render "models/$(basename "$model")" "$(basename "$5")" -o "matter_$1.png" --tracer path --spp "${6:-64}" \
        --depth 12 --size "$3" --camera "$4" ${OPTIONS:-}
    mv "matter_$1.png" "$out"
}

show alpha AlphaBlendModeTest.glb 480x200 0,1.5,11.2,0,1.05,0,24 "$sun"
show normals NormalTangentTest.glb 360x360 0,-.12,4,0,-.12,0,33 "$sun"
show transform TextureTransformTest.gltf 340x240 0,-.05,4,0,-.05,0,33 "$sun"
show clearcoat ClearCoatTest.glb 290x350 -2.13,.3,20,-2.13,.3,0,38 "$sun"
show specular SpecularTest.glb 360x250 -.19,0,1.2,-.19,0,0,38 "$sun"
show rough_glass TransmissionRoughnessTest.glb 370x176 0,.1,2.6,0,0,0,22 "$sky" 200
show attenuation AttenuationTest.glb 280x280 0,0,32,0,0,0,37 "$sky" 200
show sunglasses SunglassesKhronos.glb 400x280 .13,.12,.2,0,.025,-.05,36 "$sky"
show anisotropy_rotation AnisotropyRotationTest.glb 400x380 0,0,11,0,0,0,28 "$sun" 200
show anisotropy_strength AnisotropyStrengthTest.glb 320x320 -.45,2.7,14,-.45,2.7,0,33 "$sun" 100
show cesium_man CesiumMan.glb 260x400 2.4,1.2,2,0,.76,0,33 "$sun"
show fox Fox.glb 400x320 170,80,140,0,36,-8,38 "$sun"
kaykit=$here/../../scenes/kaykit_dungeon
show kaykit "$kaykit/chest.fbx" 360x300 2.4,2,3,0,.55,0,34 "$sun"
