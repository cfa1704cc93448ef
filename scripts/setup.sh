# setup.sh -- what ./run and ./test share: the Debian packages, the configuration, the build. Sourced, from the source folder.

build_dir=build/release

# The compiler and its tools (make is for plugins out of tree: cmake's default there); what the program is built from; what it
# needs to run. libgl1-mesa-dri: OpenGL without a driver of the machine's own, so that the window also opens on a virtual display.
build_packages="g++ cmake ninja-build make pkg-config
    ocl-icd-opencl-dev opencl-c-headers opencl-clhpp-headers libassimp-dev libopenmesh-dev libglm-dev libstb-dev libopenexr-dev
    libcli11-dev nlohmann-json3-dev libtbb-dev libseccomp-dev zlib1g-dev libimgui-dev libglfw3-dev libepoxy-dev
    libgl1-mesa-dri fonts-dejavu-core"
# Tests compare with Embree, on PoCL, in a window on a virtual display.
test_packages="pocl-opencl-icd libgtest-dev libembree-dev oclgrind clang-format
    xvfb xauth xdotool imagemagick"

# What scripts/full_test adds.
check_packages="clang-tidy"

say() { printf '%s\n' "$*" >&2; }
die() {
    say "$(basename "$0"): $*"
    exit 1
}

is_debian() { command -v dpkg-query >/dev/null 2>&1 && command -v apt-get >/dev/null 2>&1; }

# Any OpenCL driver serves; PoCL is the one that needs nothing but a CPU.
driver_packages() {
    if ! ls "${OCL_ICD_VENDORS:-/etc/OpenCL/vendors}"/*.icd >/dev/null 2>&1; then echo pocl-opencl-icd; fi
}

# installed PACKAGE... -> lines "name version" of those that are installed. dpkg-query fails when one is unknown: that is an answer.
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

# On a terminal apt-get shows its progress; elsewhere only what went wrong.
apt() {
    local out=/dev/null
    [ ! -t 2 ] || out=/dev/stderr
    as_root env DEBIAN_FRONTEND=noninteractive apt-get -y -q -o Dpkg::Use-Pty=0 "$@" </dev/null >"$out"
}

# install_packages PACKAGE...: those that are missing, through apt-get.
install_packages() {
    local have missing="" package
    if ! is_debian; then
        say "This is not a Debian system. The build needs what these Debian packages hold; install your system's own:"
        say "    $(echo $*)"
        return 0
    fi
    have=" $(installed "$@" | cut -d ' ' -f 1 | tr '\n' ' ')"
    for package in "$@"; do
        case "$have" in *" $package "*) ;; *) missing="$missing $package" ;; esac
    done
    [ -n "$missing" ] || return 0
    say "Installing with apt-get:$missing"
    # The lists of packages may be missing, or so old that their files are gone: then fetch them, and only then.
    if ! apt-get -s -q install --no-install-recommends $missing </dev/null >/dev/null 2>&1 ||
        ! apt install --no-install-recommends $missing; then
        say "Fetching the lists of packages first (apt-get update)"
        apt update || die "apt-get update failed, see above: is there a network, and a Debian mirror in /etc/apt?"
        apt install --no-install-recommends $missing || die "apt-get could not install$missing: see above"
    fi
}

# configure PACKAGE...: again only when the build folder is new, a package came, went or changed, or CLARITY_WERROR asks for
# another configuration. Ninja looks after everything else.
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

# build TARGET...
build() {
    # Ninja counts on a terminal; elsewhere a long build says at least that it is one.
    [ -t 2 ] || [ -x "$build_dir/bin/clarity" ] || say "Building (some minutes on a small machine)"
    ninja -C "$build_dir" -j "$(nproc)" $([ -t 2 ] || echo --quiet) "$@" >&2 || die "the build failed, see above"
}
