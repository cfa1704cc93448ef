# virtual_cluster.sh -- a cluster of Slurm on this machine: a controller and three nodes, each of which is one slurmd. To be sourced by bash,
# as root; needs no systemd. Packages: slurm-wlm, munge.
#   start_cluster FOLDER     sets SLURM_CONF; the folder holds configuration, state and logs
#   start_node NAME          also after it was killed, as the system's service manager would do it
#   node_pid NAME            the process of its slurmd
#   stop_cluster             ends all daemons and jobs
# All processes of the cluster, and of the jobs, have CLUSTER_MARK in their environment, by which marked_processes finds them.

cluster_nodes="n1 n2 n3"

# marked_processes NAME...: ids of the living processes with one of these names that belong to the cluster or to its jobs.
marked_processes() {
    local folder name wanted=" $* "
    for folder in /proc/[0-9]*; do
        read -r name 2>/dev/null <"$folder/comm" || continue
        [[ $wanted == *" $name "* ]] || continue
        # A dead process that nobody has waited for has no environment.
        if grep -qzsF "CLUSTER_MARK=$CLUSTER_MARK" "$folder/environ"; then echo "${folder#/proc/}"; fi
    done
}

# step_processes: ids of the slurmstepd that run our jobs. They overwrite their environment; that of their scripts has the mark.
step_processes() {
    local pid parent name
    for pid in $(marked_processes bash slurm_script); do
        parent=$(sed -n 's/^PPid:\s*//p' "/proc/$pid/status" 2>/dev/null)
        read -r name 2>/dev/null <"/proc/$parent/comm" || continue
        if [ "$name" = slurmstepd ]; then echo "$parent"; fi
    done | sort -u
}

start_node() { slurmd -N "$1" </dev/null >>"$cluster/$1.out" 2>&1; }
node_pid() { cat "$cluster/slurmd.$1.pid" 2>/dev/null; }

# wait_until SECONDS COMMAND...: until the command succeeds.
wait_until() {
    local end=$((SECONDS + $1))
    shift
    until "$@" >/dev/null 2>&1; do
        ((SECONDS < end)) || return 1
        sleep 0.2
    done
}

start_cluster() {
    cluster=$1
    local port=${CLUSTER_PORT:-21817} name
    mkdir -p "$cluster/state" "$cluster/munge"
    chmod 700 "$cluster/munge"
    export CLUSTER_MARK=$cluster SLURM_CONF=$cluster/slurm.conf
    head -c 1024 /dev/urandom >"$cluster/munge/key"
    chmod 600 "$cluster/munge/key"
    # The folder may lie below one that others may write to, such as /tmp: --force.
    munged --force --socket="$cluster/munge/socket" --key-file="$cluster/munge/key" --pid-file="$cluster/munge/pid" \
        --log-file="$cluster/munge/log" --seed-file="$cluster/munge/seed" 2>>"$cluster/munge/out" || return 1
    # cred_expire: a job that is queued again waits until its credentials have expired. The other times are short for the same reason: that a
    # lost task is noticed within seconds.
    cat >"$SLURM_CONF" <<CONF
ClusterName=virtual
SlurmctldHost=$(hostname)
SlurmctldAddr=127.0.0.1
SlurmctldPort=$port
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket=$cluster/munge/socket,cred_expire=5
CredType=cred/munge
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmdParameters=config_overrides
StateSaveLocation=$cluster/state
SlurmdSpoolDir=$cluster/spool.%n
SlurmctldPidFile=$cluster/slurmctld.pid
SlurmdPidFile=$cluster/slurmd.%n.pid
SlurmctldLogFile=$cluster/slurmctld.log
SlurmdLogFile=$cluster/slurmd.%n.log
ReturnToService=2
SlurmdTimeout=6
BatchStartTimeout=5
MessageTimeout=5
KillWait=5
CompleteWait=0
MinJobAge=3600
JobRequeue=1
JobCompType=jobcomp/none
AccountingStorageType=accounting_storage/none
SchedulerType=sched/backfill
SchedulerParameters=sched_interval=2,bf_interval=2,batch_sched_delay=0
NodeName=n[1-3] NodeHostname=$(hostname) NodeAddr=127.0.0.1 Port=[$((port + 1))-$((port + 3))] CPUs=2 RealMemory=1000 State=UNKNOWN
PartitionName=all Nodes=n[1-3] Default=YES MaxTime=INFINITE State=UP
CONF
    slurmctld </dev/null >>"$cluster/slurmctld.out" 2>&1 || return 1
    for name in $cluster_nodes; do start_node "$name" || return 1; done
    wait_until 30 nodes_idle
}
nodes_idle() { [ "$(sinfo -h -N -t idle -o %N | sort -u | wc -l)" = 3 ]; }

stop_cluster() {
    [ -n "${CLUSTER_MARK-}" ] || return 0
    local pids try
    scancel -u root 2>/dev/null
    for try in 1 2 3 4 5; do
        pids="$(step_processes) $(marked_processes slurmctld slurmd munged clarity slurm_script)"
        pids=$(echo $pids)
        [ -n "$pids" ] || return 0
        if ((try < 4)); then kill $pids 2>/dev/null; else kill -9 $pids 2>/dev/null; fi
        sleep 1
    done
}
