# frames.sh -- functions of the recipes in this folder: renders one share of the frames of a scene. To be sourced by bash.

say() { printf '%s: %s\n' "${recipe:-clarity farm}" "$*" >&2; }
die() {
    say "$*"
    exit 2
}

# Words before a command that the kernel kills when this shell dies, so that no program is left on a node whose job is gone.
# Where util-linux is too old for that (before 2.33), the job's cgroup has to do it.
tied_prefix="setpriv --pdeathsig KILL"
$tied_prefix true 2>/dev/null || tied_prefix=""

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

# render_share K N FRAMES OUT SCENE [OPTION...]: renders the K-th of N shares of FRAMES (K from 1: every N-th frame, from the K-th on). Frames
# that are there already with the record of the same scene and settings are left out; a frame that was interrupted goes on with its checkpoint.
# After a crash it begins again, up to five runs in a row that bring no picture and no checkpoint. SIGTERM to this shell ends the program.
# Returns 0 if all pictures of the share are there, 130 after SIGTERM, else the program's exit code. Sets `advanced` to 1 if something was done.
render_share() {
    local share=$1 shares=$2 frames=$3 out=$4 first last step frame before now tries=0 code stopped="" child=""
    local files=() saves=()
    shift 4
    split_frames "$frames"
    picture "$out" "$first" >/dev/null
    mkdir -p "$(dirname "$out")" || return 1
    advanced=0
    # Only colours are sums of samples, which a checkpoint can hold.
    [[ " $* " == *" --aov"* ]] || saves=(--checkpoint "${out%.*}.checkpoint" --resume "${out%.*}.checkpoint")
    for ((frame = first + (share - 1) * step; frame <= last; frame += step * shares)); do
        files+=("$(picture "$out" "$frame")" "$(picture "${out%.*}.checkpoint" "$frame")")
    done
    # Inode and time of each file: a new picture changes them, also one in the place of an old one.
    state() { stat -c '%i %Y %n' "${files[@]}" 2>/dev/null; }
    before=$(state)
    trap 'stopped=1; [ -z "$child" ] || kill -TERM "$child" 2>/dev/null' TERM INT
    while :; do
        if [ -n "$stopped" ]; then
            code=130
            break
        fi
        # A plain command, so that $! is the program itself and a signal reaches it.
        $tied_prefix "$clarity" render "$@" --frames "$frames" --frames-of "$share/$shares" --skip-existing "${saves[@]}" -o "$out" </dev/null &
        child=$!
        [ -z "$stopped" ] || kill -TERM "$child" # the signal came before $child was known
        # A signal ends `wait` before the program has ended.
        while :; do
            wait "$child"
            code=$?
            kill -0 "$child" 2>/dev/null || break
        done
        child=""
        now=$(state)
        if [ "$now" != "$before" ]; then advanced=1 tries=0; fi
        before=$now
        [ -z "$stopped" ] || { code=130; break; }
        # Wrong options, no device, a scene that cannot be read, a kernel that does not compile: trying again changes nothing.
        case $code in 0 | 2 | 3 | 4 | 5) break ;; esac
        tries=$((tries + 1))
        if ((tries >= 5)); then break; fi
        # A checkpoint of other settings would be refused again and again.
        if ((tries == 2)); then saves=("${saves[@]:0:2}"); fi
        say "clarity ended with exit code $code; it begins again"
        # What was wrong for a moment, such as memory or the file server, may be right then.
        sleep "$tries" &
        wait $!
    done
    trap - TERM INT
    return "$code"
}
