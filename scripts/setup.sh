# setup.sh -- functions of ./run, ./test and scripts/full_test: Debian packages, configuration, build. To be sourced in the source
# folder.

build_dir=build/release

# Compiler and tools (make: cmake's default for plugins outside of the tree), the libraries for the build, and the packages that the
# program needs at run time. libgl1-mesa-dri: OpenGL in software, so that the window also opens on a virtual display.
# fonts-dejavu-core: fonts that become part of the program.
build_packages="g++ cmake ninja-build make pkg-config libdraco-dev libmeshoptimizer-dev
    ocl-icd-opencl-dev opencl-c-headers opencl-clhpp-headers libassimp-dev libopenmesh-dev libglm-dev libstb-dev libopenexr-dev
    libcli11-dev nlohmann-json3-dev libtbb-dev libseccomp-dev libxxhash-dev zlib1g-dev libimgui-dev libglfw3-dev libepoxy-dev
    libgl1-mesa-dri fonts-dejavu-core libjs-chart.js"
# The tests compare with Embree, use numpy and draw with matplotlib, build strangers' sources by bubblewrap, run kernels on PoCL and oclgrind,
# open the window on a virtual display, and pages in Chromium.
test_packages="pocl-opencl-icd libgtest-dev libembree-dev oclgrind clang-format-19 python3-numpy python3-matplotlib
    bubblewrap xvfb xauth xdotool imagemagick chromium"

# Additional packages for scripts/full_test.
check_packages="clang-tidy"

# For its step `farm`: a cluster on this machine.
farm_packages="slurm-wlm munge ffmpeg python3 libopenmpi-dev openmpi-bin"

say() { printf '%s\n' "$*" >&2; }
die() {
    say "$(basename "$0"): $*"
    exit 1
}

is_debian() { command -v dpkg-query >/dev/null 2>&1 && command -v apt-get >/dev/null 2>&1; }

# Any OpenCL driver will do. If there is none, install PoCL, which needs only a CPU.
driver_packages() {
    if ! ls "${OCL_ICD_VENDORS:-/etc/OpenCL/vendors}"/*.icd >/dev/null 2>&1; then echo pocl-opencl-icd; fi
}

# installed PACKAGE...: prints a line "name version" for each one that is installed. It is no error if dpkg-query does not know one.
installed() { dpkg-query -W -f '${db:Status-Status} ${Package} ${Version}\n' "$@" 2>/dev/null | sed -n 's/^installed //p'; }

as_root() {
    if [ "$(id -u)" = 0 ]; then
        "$@"
    elif command -v sudo >/dev/null 2>&1; then
        sudo "$@"
    else
        die "the packages above need root rights and there is no sudo: install them as root (apt-get install ...), then run this again"
    fi
}

# apt ARGUMENT...: runs apt-get. On a terminal it shows its progress; elsewhere it prints only errors. Another process may hold one
# of apt's locks, as on a machine that updates itself after its start: then this waits and says so, for at most half an hour. Not by
# apt's own DPkg::Lock::Timeout, which leaves out the locks of the lists and of the downloads (apt 2.6).
apt() {
    local out=/dev/null errors code holder told="" end=$((SECONDS + ${apt_patience_s:-1800}))
    [ ! -t 2 ] || out=/dev/stderr
    errors="$(mktemp)" || die "no temporary file: is there room in ${TMPDIR:-/tmp}?"
    while :; do
        as_root env LC_ALL=C DEBIAN_FRONTEND=noninteractive apt-get -y -q -o Dpkg::Use-Pty=0 "$@" </dev/null >"$out" 2>"$errors"
        code=$?
        holder="$(sed -n 's/^E: Could not get lock \([^ ]*\)\. It is held by \(.*[^.]\)\.*$/\2, which holds \1/p' "$errors" | head -n 1)"
        [ $code != 0 ] && grep -q '^E: Could not get lock' "$errors" && [ $SECONDS -lt $end ] || break
        [ "$told" = "${holder:=another program that uses apt}" ] || say "Waiting for $holder"
        told="$holder"
        sleep 2
    done
    cat "$errors" >&2
    rm -f "$errors"
    return $code
}

# packaged PACKAGE...: prints a line for each one that apt's lists offer. Not by what `apt-get install` says: it takes a name that it does
# not know, such as g++, for a pattern.
packaged() {
    LC_ALL=C apt-cache policy "$@" | awk '/^[^ ]/ { sub(/:$/, ""); name = $0 } $1 == "Candidate:" && $2 != "(none)" { print name }'
}

# without LIST WORD...: prints the words that the list, one a line, does not have.
without() { printf '%s\n' "${@:2}" | grep -vxF -e "$1"; }

fetch_lists() {
    say "Fetching the lists of packages first (apt-get update)"
    apt update || die "apt-get update failed, see above: is there a network, and a Debian mirror in /etc/apt?"
}

# install_packages PACKAGE...: installs those that are missing with apt-get. What this system does not package is left out: the
# configuration and the tests then say which part needs it.
install_packages() {
    local missing lacking
    if ! is_debian; then
        say "This is not a Debian system. The build needs what these Debian packages hold; install your system's own:"
        say "    $(echo $*)"
        return 0
    fi
    missing="$(without "$(installed "$@" | cut -d ' ' -f 1)" "$@")"
    [ -n "$missing" ] || return 0
    LC_ALL=C apt-cache policy | grep -q ' Packages$' || fetch_lists # a new system has no lists
    lacking="$(without "$(packaged $missing)" $missing)"
    if [ -n "$lacking" ]; then
        say "Left out, because this system does not package it:" $lacking
        missing="$(without "$lacking" $missing)"
        [ -n "$missing" ] || return 0
    fi
    say "Installing with apt-get:" $missing
    # The lists may be so old that the files they name are gone.
    if ! apt install --no-install-recommends $missing; then
        fetch_lists
        apt install --no-install-recommends $missing || die "apt-get could not install" $missing": see above"
    fi
}

# configure PACKAGE...: configures the build folder if it is new, if a package was installed, removed or updated, or if
# CLARITY_WERROR asks for another configuration. Ninja detects everything else.
configure() {
    local stamp="$build_dir/packages" now=""
    if is_debian; then now="$(installed "$@")"; fi
    now="$now
werror=${CLARITY_WERROR:-as it is}"
    if [ -f "$build_dir/build.ninja" ] && [ "$now" = "$(cat "$stamp" 2>/dev/null)" ]; then return 0; fi
    rm -f "$stamp"
    mkdir -p "$build_dir"
    say "Configuring (log: $build_dir/configure.log)"
    if ! cmake --preset release ${CLARITY_WERROR:+-DCLARITY_WERROR=$CLARITY_WERROR} >"$build_dir/configure.log" 2>&1; then
        cat "$build_dir/configure.log" >&2
        die "cmake failed, see above"
    fi
    grep 'LEFT OUT' "$build_dir/configure.log" >&2
    printf '%s\n' "$now" >"$stamp"
}

# build TARGET...: builds the targets, or all without one. A terminal shows Ninja's line of progress; elsewhere every tenth of the
# way is a line, beside what compilers say.
build() {
    [ -x "$build_dir/bin/clarity" ] || say "Building for the first time: some minutes on a small machine; later only what changed"
    if [ -t 2 ]; then
        NINJA_STATUS="[%f/%t, %p] " ninja -C "$build_dir" -j "$(nproc)" "$@" >&2 || die "the build failed, see above"
        return
    fi
    local line done_steps steps tenths=0
    NINJA_STATUS="@%f/%t@" ninja -C "$build_dir" -j "$(nproc)" "$@" 2>&1 | while IFS= read -r line; do
        case "$line" in
        @*@Re-*) ;; # Ninja looks for new files and configures anew
        @*/*@*)
            line="${line#@}" done_steps="${line%%/*}" steps="${line#*/}" steps="${steps%%@*}"
            if [ $((10 * done_steps / steps)) -gt $tenths ]; then
                tenths=$((10 * done_steps / steps))
                say "Building: $((10 * tenths)) % ($done_steps of $steps steps)"
            fi
            ;;
        "ninja: Entering directory"* | "ninja: no work to do.") ;;
        *) say "$line" ;;
        esac
    done
    [ "${PIPESTATUS[0]}" = 0 ] || die "the build failed, see above"
}
