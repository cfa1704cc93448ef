# on the device
R=$PWD
(python3 -c "
import numpy as np
a=[np.ones(8<<30,np.uint8) for _ in range(5)]
") & 
fill=$!
mkdir -p /tmp/big; tar xzf .carry/big.tar.gz -C /tmp/big
source .carry/device_setup.sh /tmp/big
wait $fill; free -g | head -2; date
B=/tmp/b/bin/clarity
V="--accel bvh4 --accel cwbvh"; for v in $VARIANTS; do V="$V --accel cwbvh,$v"; done
cd /tmp
export CLARITY_SCENES=/tmp/big/scenes
run() { timeout $1 $B bench large --device gpu --no-peers --max-spread 0.5 $V --time-limit $2 "${@:4}" --json $OUT/$3.json > $OUT/$3.txt 2>&1; tail -3 $OUT/$3.txt; date; }
eval "$RUNS"
nvidia-smi --query-gpu=memory.used,memory.total --format=csv
