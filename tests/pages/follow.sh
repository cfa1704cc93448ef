#!/bin/bash
# follow.sh BUILD CMAKE C CXX FLAGS -- installs the program, the SDK and the pages into a folder with a blank in its path, and follows the
# installed pages literally: writes their files, and runs their commands. Also looks for links between pages that lead nowhere.
set -eu
build=$1 cmake=$2
export CC=$3 CXX=$4 CXXFLAGS=$5
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$build/tests/pages/followed
rm -rf "$root"
mkdir -p "$root/home"
prefix="$root/installed here"
"$cmake" --install "$build" --prefix "$prefix" > "$root/install.log"
unset CLARITY_PLUGIN_PATH CLARITY_WORKER CLARITY_DEVICE CLARITY_KERNEL_PATH
export CMAKE_PREFIX_PATH=$prefix XDG_DATA_HOME=$root/home PATH=$prefix/bin:$PATH
fail() { echo "$*" >&2; exit 1; }

docs=$(dirname "$(find "$prefix" -name write_an_importer.md)")
[ -f "$docs/plugins.md" ] || fail "the pages are not installed together"
for page in plugins plugin_abi clarity_bvh check write_an_acceleration_structure write_an_importer write_a_shape light_exercises; do
    # Links stand in the text, not in blocks.
    for link in $(awk '/^```/ { code = !code; next } !code' "$docs/$page.md" | grep -o '](\([^)# ]*\)[^) ]*)' | sed 's/^](//; s/[#)].*//' | grep -v '^http' | sort -u); do
        [ -e "$docs/$link" ] || fail "$page.md: the link '$link' leads to nothing where it is installed"
    done
done
code=0
clarity devices > /dev/null 2>&1 || code=$?
if [ $code = 3 ]; then echo "SKIPPED: no OpenCL device"; exit 77; fi

# follow PAGE: in a folder of its own.
follow() {
    mkdir "$root/my $1"
    awk -f "$here/to_script.awk" "$docs/$1.md" > "$root/$1.sh"
    (cd "$root/my $1" && bash -ex "$root/$1.sh") || fail "$1.md: a command of the page failed"
}
follow write_an_acceleration_structure
follow write_an_importer
follow write_a_shape
follow plugins
follow light_exercises
for picture in write_an_acceleration_structure/boxes write_an_acceleration_structure/tree write_an_importer/house write_a_shape/dish plugins/median; do
    [ -s "$root/my $picture.png" ] || fail "the page wrote no $picture.png"
done
rm -rf "$root"
