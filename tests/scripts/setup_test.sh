#!/bin/bash
# setup_test.sh SOURCE_FOLDER -- tests scripts/setup.sh: apt() waits while another process holds a lock of apt's, install_packages()
# leaves out what a system does not package, and build() says how far it is. apt-get works on a folder of its own, so that this needs no root and changes nothing.
set -u
cd "$1" || exit 1
command -v apt-get >/dev/null && command -v ninja >/dev/null && command -v perl >/dev/null || {
    echo "NOT TESTED: needs apt-get, ninja and perl"
    exit 77
}
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
failed=0
fail() {
    echo "FAILED: $*"
    cat "$folder/output"
    failed=1
}

# ---- apt
mkdir -p "$folder"/var/lib/apt/lists/partial "$folder"/var/lib/dpkg "$folder"/var/cache/apt/archives/partial "$folder"/etc/apt/{apt.conf.d,preferences.d}
touch "$folder/var/lib/dpkg/status"
cat >"$folder/apt.conf" <<END
Dir "$folder/";
Dir::State::status "$folder/var/lib/dpkg/status";
Dir::Etc::sourcelist "/dev/null";
Dir::Etc::sourceparts "/dev/null";
END
export APT_CONFIG="$folder/apt.conf"

# hold FILE: locks it as apt does, in another process, until let_go.
hold() {
    rm -f "$folder/held" "$folder/released"
    perl -MFcntl -e 'my ($file, $held, $released) = @ARGV;
        my $how = pack("s s x4 q q i x4", F_WRLCK, 0, 0, 0, 0);
        open(my $lock, ">", $file) or die "$file: $!"; fcntl($lock, F_SETLK, $how) or die "no lock: $!";
        open(my $ready, ">", $held) or die; select(undef, undef, undef, 0.05) until -e $released' "$1" "$folder/held" "$folder/released" &
    holder=$!
    while kill -0 $holder 2>/dev/null; do [ -e "$folder/held" ] && return 0 || sleep 0.1; done
    fail "$1 could not be locked"
}
let_go() { touch "$folder/released" && wait $holder; }
# run_apt ARGUMENT...: apt() as ./run calls it, without sudo.
run_apt() { (. scripts/setup.sh && as_root() { "$@"; } && apt_patience_s=${patience:-600} && apt "$@") >"$folder/output" 2>&1; }

pairs=("update:var/lib/apt/lists/lock" "install:var/lib/dpkg/lock-frontend" "install:var/lib/dpkg/lock" "install:var/cache/apt/archives/lock")
[ -z "${CLARITY_QUICK_TESTS:-}" ] || pairs=("${pairs[@]:0:2}")
for pair in "${pairs[@]}"; do
    verb="${pair%%:*}" lock="$folder/${pair#*:}"
    hold "$lock"
    : >"$folder/output"
    run_apt $verb &
    waiter=$!
    while kill -0 $waiter 2>/dev/null && ! grep -q '^Waiting' "$folder/output"; do sleep 0.1; done
    # `apt-get install` without a package to fetch does not ask for the lock of the downloads.
    case "$pair" in *archives*) ;; *) kill -0 $waiter 2>/dev/null || fail "apt $verb ended while $lock was held" ;; esac
    let_go
    wait $waiter || fail "apt $verb while $lock was held: code $?"
    case "$pair" in *archives*) ;; *) grep -q "^Waiting for process $holder (perl), which holds $lock\$" "$folder/output" || fail "apt $verb did not say that it waits for $lock" ;; esac
    [ "$(grep -c Waiting "$folder/output")" -le 1 ] || fail "it said so several times"
done
hold "$folder/var/lib/apt/lists/lock"
patience=1 run_apt update && fail "an update that cannot lock succeeded"
grep -q '^E: Could not get lock' "$folder/output" || fail "the reason is not shown once patience ends"
let_go
run_apt install no-such-package && fail "a package that does not exist was installed"
grep -q 'Unable to locate package no-such-package' "$folder/output" || fail "apt's message is not shown"
grep -q Waiting "$folder/output" && fail "it waited although no lock was held"

# ---- packages of a system that has one of them installed, packages two, and knows nothing of the others
mkdir -p "$folder/archive"
printf 'Package: %s\nVersion: 1\nArchitecture: all\nMaintainer: nobody\nDescription: none\nFilename: ./none.deb\nSize: 1\nMD5sum: 00000000000000000000000000000000\n\n' \
    offered++ offered.js >"$folder/archive/Packages"
echo "deb [trusted=yes] file:$folder/archive ./" >"$folder/sources.list"
sed -i "s|sourcelist \"/dev/null\"|sourcelist \"$folder/sources.list\"|" "$folder/apt.conf"
cat >"$folder/install" <<'END'
. scripts/setup.sh
as_root() { "$@"; }
installed() { echo "present 1"; }
apt() {  # fetches lists as ever, and says what it would install
    if [ "$1" = update ]; then apt-get -q -o APT::Sandbox::User=root update >/dev/null; else echo "asked for: ${*:3}"; fi
}
install_packages "$@"
END
# expects LINES PACKAGE...: what install_packages says, and asks of apt.
expects() {
    bash "$folder/install" "${@:2}" >"$folder/output" 2>&1 || fail "install_packages ${*:2}: code $?"
    [ "$(cat "$folder/output")" = "$1" ] || fail "install_packages ${*:2} said otherwise: $1"
}
expects "Fetching the lists of packages first (apt-get update)
Left out, because this system does not package it: nowhere++ nowhere
Installing with apt-get: offered++ offered.js
asked for: offered++ offered.js" present nowhere++ offered++ nowhere offered.js
expects "Left out, because this system does not package it: nowhere" present nowhere
expects "Installing with apt-get: offered.js
asked for: offered.js" offered.js
expects "" present

# ---- build
build_in() { (. scripts/setup.sh && build_dir="$folder/$1" && build "${@:2}") >"$folder/output" 2>&1; }
mkdir "$folder/good" "$folder/bad"
{
    printf 'rule step\n  command = touch $out\nrule warn\n  command = echo "a.cpp:1: warning: w"; touch $out\nrule fail\n  command = echo "b.cpp:1: error: e"; false\n'
    for i in $(seq 39); do echo "build step$i: step"; done
    echo "build warning: warn"
} >"$folder/good/build.ninja"
build_in good || fail "a good build: code $?"
for share in 10 50 100; do
    [ "$(grep -c "^Building: $share %" "$folder/output")" = 1 ] || fail "no line says $share %"
done
[ "$(grep -c '^Building: ' "$folder/output")" -le 10 ] || fail "more lines of progress than tenths"
grep -q '^a.cpp:1: warning: w$' "$folder/output" || fail "a warning is lost"
build_in good || fail "nothing to build: code $?"
grep -q '%\|ninja:' "$folder/output" && fail "progress without work"
{
    cat "$folder/good/build.ninja"
    echo "build failing: fail"
} >"$folder/bad/build.ninja"
build_in bad && fail "a build that fails: code 0"
grep -q '^b.cpp:1: error: e$' "$folder/output" && grep -q 'the build failed, see above' "$folder/output" || fail "the error is lost"
exit $failed
