# bare.sh -- functions of scripts that try Clarity in a bare Debian: a folder with a system of minimal size. To be sourced after
# setup.sh, in the source folder.

# apart SCRIPT ARGUMENT...: begins the script anew where mounts are seen, and processes live, by it alone.
apart() {
    [ "$(id -u)" = 0 ] || die "needs root, for chroot"
    [ -z "${CLARITY_APART-}" ] || return 0
    install_packages debootstrap
    CLARITY_APART=1 exec unshare -m -p --fork --kill-child "$@"
}

# Release of this system: bookworm is Debian 12, trixie is Debian 13.
this_release() { (. /etc/os-release && echo "$VERSION_CODENAME"); }

# make_bare RELEASE FOLDER [PACKAGE...]: a system of this release with these packages, from the mirror that apt uses here, unless the
# folder has it.
make_bare() {
    local mirror=${DEBIAN_MIRROR:-$(apt-get indextargets --format '$(REPO_URI)' 'Origin: Debian' 'Identifier: Packages' | grep -v security | head -n 1)}
    local packages="${*:3}"
    [ ! -f "$2.done" ] || return 0
    say "a bare Debian, $1, in $2 (debootstrap)"
    rm -rf --one-file-system "$2"
    mkdir -p "$2"
    debootstrap --variant=minbase ${packages:+--include=${packages// /,}} "$1" "$2" "$mirror" >"$2.log" 2>&1 || die "debootstrap failed: see $2.log"
    # No service starts there, and apt finds what this machine finds.
    printf '#!/bin/sh\nexit 101\n' >"$2/usr/sbin/policy-rc.d"
    chmod +x "$2/usr/sbin/policy-rc.d"
    cp -a /etc/apt/apt.conf.d/. "$2/etc/apt/apt.conf.d/"
    touch "$2.done"
}

# mount_bare FOLDER: mounts what programs expect. Devices are those that every system has, terminals are its own.
mount_bare() {
    local device
    cp -L /etc/resolv.conf /etc/hosts "$1/etc/" 2>/dev/null
    mount -t proc proc "$1/proc"
    mount --rbind -o ro /sys "$1/sys" # PoCL counts cores and memory there
    mount -t tmpfs -o mode=755 devices "$1/dev"
    for device in null zero full random urandom tty; do
        touch "$1/dev/$device"
        mount --bind "/dev/$device" "$1/dev/$device"
    done
    ln -s /proc/self/fd "$1/dev/fd"
    for device in 0:stdin 1:stdout 2:stderr; do ln -s "fd/${device%:*}" "$1/dev/${device#*:}"; done
    mkdir "$1/dev/pts" "$1/dev/shm"
    mount -t devpts -o newinstance,ptmxmode=0666,mode=620,gid=5 devpts "$1/dev/pts"
    ln -s pts/ptmx "$1/dev/ptmx"
    mount -t tmpfs -o mode=1777 shared "$1/dev/shm"
}
