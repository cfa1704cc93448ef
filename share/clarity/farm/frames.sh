# frames.sh -- functions of the recipes in this folder: renders one share of the frames of a scene. To be sourced by bash.

say() { printf '%s: %s\n' "${recipe:-clarity farm}" "$*" >&2; }
die() {
    say "$*"
    exit 2
}

# Runs a command that the kernel kills when this shell dies, so that no program is left on a node whose job is gone.
# Where util-linux is too old for that (before 2.33), the job's cgroup has to do it.
if setpriv --pdeathsig KILL true 2>/dev/null; then
    tied() { setpriv --pdeathsig KILL "$@"; }
    tied_prefix="setpriv --pdeathsig KILL"
else
    tied() { "$@"; }
    tied_prefix=""
fi

# split_frames A-B[/STEP]: sets first, last, step.
split_frames() {
    [[ $1 =~ ^([0-9]+)(-([0-9]+))?(/([0-9]+))?$ ]] || die "frames '$1': expected A-B or A-B/STEP, as in 1-120 or 1-120/2"
    first=$((10#${BASH_REMATCH[1]})) last=$((10#${BASH_REMATCH[3]:-${BASH_REMATCH[1]}})) step=$((10#${BASH_REMATCH[5]:-1}))
    ((last >= first && step >= 1)) || die "frames '$1': the smaller number comes first, and the step is at least 1"
}

# picture OUT NUMBER: the name of a frame, in which the last run of # is the number with as many digits.
picture() {
    [[ $1 =~ ^(.*[^#]|)(#+)([^#/]*)$ ]] || die "output '$1': put #### into its name, for the frame's number"
    printf '%s%0*d%s\n' "${BASH_REMATCH[1]}" "${#BASH_REMATCH[2]}" "$2" "${BASH_REMATCH[3]}"
}

# count_pictures OUT FIRST LAST STEP: how many of these pictures are there.
count_pictures() {
    local n=0 frame
    for ((frame = $2; frame <= $3; frame += $4)); do
        if [ -s "$(picture "$1" "$frame")" ]; then n=$((n + 1)); fi
    done
    echo "$n"
}

# render_share K N FRAMES OUT SCENE [OPTION...]: renders frames K, K + N, K + 2N, ... of FRAMES (K from 1), those that are there left out.
# After a crash it begins again, three times as long as no new picture comes. SIGTERM to this shell ends the program, which then leaves no
# part of a picture. Returns 0 if all pictures of the share are there, 130 after SIGTERM, else the program's exit code. Sets `fresh`, the
# number of new pictures.
render_share() {
    local share=$1 shares=$2 frames=$3 out=$4 first last step before now tries=0 code stopped="" child=""
    shift 4
    split_frames "$frames"
    picture "$out" "$first" >/dev/null
    mkdir -p "$(dirname "$out")" || return 1
    first=$((first + (share - 1) * step)) step=$((step * shares)) fresh=0
    if ((first > last)); then
        say "share $share of $shares: there are fewer frames than shares, so nothing is left to do"
        return 0
    fi
    before=$(count_pictures "$out" "$first" "$last" "$step")
    local begin=$before
    trap 'stopped=1; [ -z "$child" ] || kill -TERM "$child" 2>/dev/null' TERM INT
    while :; do
        # A plain command, so that $! is the program itself and a signal reaches it.
        $tied_prefix "$clarity" render "$@" --frames "$first-$last/$step" --skip-existing -o "$out" </dev/null &
        child=$!
        # A signal ends `wait` before the program has ended.
        while :; do
            wait "$child"
            code=$?
            kill -0 "$child" 2>/dev/null || break
        done
        wait "$child" 2>/dev/null
        child=""
        now=$(count_pictures "$out" "$first" "$last" "$step")
        fresh=$((now - begin))
        [ -z "$stopped" ] || { code=130; break; }
        # Wrong options, no device, a scene that cannot be read, a kernel that does not compile: trying again changes nothing.
        case $code in 0 | 2 | 3 | 4 | 5) break ;; esac
        if ((now > before)); then tries=0; fi
        before=$now
        tries=$((tries + 1))
        if ((tries >= 3)); then break; fi
        say "clarity ended with exit code $code; $now pictures of this share are there; it begins again"
    done
    trap - TERM INT
    return "$code"
}
