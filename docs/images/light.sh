#!/bin/sh
# Makes the pictures of docs/light_exercises.md: docs/images/light.sh FOLDER. FOLDER: where the page was followed, as tests/pages/follow.sh
# does. `clarity` is on the PATH. Needs ImageMagick.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
cd "$1"
strip() { out=$1; shift; convert "$@" -bordercolor white -border 2 +append -quality 85 "$here/light_$out.jpg"; }
path="--tracer path --spp 16 --size 240x150"
for strategy in nee bsdf mis; do clarity render plates.scene -o $strategy.png $path --depth 1 --exposure .3 --strategy $strategy; done
for pick in table tree; do clarity render lamps.scene -o $pick.png $path --depth 2 --light-sampling $pick; done
strip visibility visibility.png
strip bounces furnace.png second.png
strip size small.png large.png
strip materials materials.png
strip strategies nee.png bsdf.png mis.png
strip lamps table.png tree.png
# Points in a grid of 8 x 8 squares.
for sampler in independent sobol; do
    {
        awk 'BEGIN { print "stroke silver"; for (i = 0; i <= 8; ++i) printf "line %d,0 %d,200 line 0,%d 200,%d\n", i * 25, i * 25, i * 25, i * 25; print "stroke none fill navy" }'
        awk -F, 'NR > 1 { x = 200 * $2; y = 200 - 200 * $3; printf "circle %g,%g %g,%g\n", x, y, x + 2, y }' $sampler.csv
    } > $sampler.draw
    convert -size 201x201 xc:white -draw "$(cat $sampler.draw)" $sampler.points.png
done
convert independent.points.png sobol.points.png -bordercolor white -border 6 +append -colors 32 "$here/light_points.png"
