#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# script/gpu-check on the emulated GPU, in parts that go on where the last one stopped: its programs build without the
# rest of standoff and its dependencies, every job runs once, every table has its rows. (steps_test.py: steps that fail.)
# labels: builds
set -euo pipefail
gpu_check() { JOBS=1 "$STANDOFF_SOURCE_DIR/script/gpu-check" --emulated "$@" >log 2>&1; }
fail() { echo "$*"; cat log; exit 1; }

gpu_check --only checks && fail "a part that is none was taken"
grep -q "there is no part 'checks', only build, check, sanitize, measure" log || fail "it is not said that there is no such part"

gpu_check --out "$PWD/results" --only build || fail "building failed"
[[ ! -e results/gpu.csv && ! -e results/check.txt ]] || fail "more than the build was done"
gpu_check --out "$PWD/results" --quick || fail "the quick check failed"
grep -q 'continuing in' log || fail "the second call began anew"
[[ $(cut -d, -f1,2,5 results/gpu.csv | tail -n +2 | tr '\n' ' ') == "goal,factory,dense goal,catapult,dense goal,terrain,dense goal,factory,sparse goal,machine_2,dense goal,many,batch_9 " ]] ||
  fail "the quick check does not measure the goals alone"
cp results/gpu.csv quick.csv
gpu_check --out "$PWD/results" --only measure || fail "measuring failed"
[[ $(head -n 7 results/gpu.csv) == $(cat quick.csv) ]] || fail "what was measured is measured again"
grep -q 'measuring the rest: 130 jobs, 6 were' log || fail "the rest is not the rest"
grep -q '^0 of [0-9]* checks went wrong' results/check.txt || fail "check.txt has no sum"
rows() { awk -F, -v table="$1" '$1 == table' results/gpu.csv | wc -l; }
while read -r table count; do
  [[ $(rows "$table") == "$count" ]] || fail "gpu.csv has $(rows "$table") rows of $table, not $count"
done <<'END'
goal 25
figure_1.1 2
table_5.1 52
table_5.2 16
table_5.3 18
table_5.4 11
table_5.5 12
END
awk -F, 'NR > 1 && !($8 > 0)' results/gpu.csv | grep . && fail "a job took no time"
grep -q '^table_5.1,factory,.*,0.64,-$' results/gpu.csv || fail "gpu.csv lacks the thesis's times"
[[ $(awk -F, '$3 ~ /^-?[0-9]/ && NF == 4' results/table-5.4.csv | wc -l) == 13 ]] || fail "table-5.4.csv lacks parts"
if python3 -c 'import warp' 2>/dev/null; then
  [[ $(grep -c ',mesh_query_point[a-z_]*,' results/peer.csv) == 8 ]] || fail "peer.csv lacks jobs"
else
  grep -q 'no module warp .*: skipped' log || fail "nothing is said of the peer that is not there"
fi
if python3 -c 'import importlib.util as u, sys; sys.exit(u.find_spec("physicsnemo") is None)'; then
  [[ $(grep -c ',signed_distance_field,' results/peer.csv) == 4 ]] || fail "peer.csv lacks jobs of PhysicsNeMo"
else
  grep -q 'no module physicsnemo .*: skipped' log || fail "nothing is said of PhysicsNeMo, which is not there"
fi
grep -q 'no NanoVDB with MeshToGrid .*: skipped' log || fail "nothing is said of the other peer that is not there"
python3 -B "$STANDOFF_SOURCE_DIR/bench/gpu_tables.py" results >tables.md || fail "no tables"
for title in Goals "Figure 1.1" "Table 5.1" "Table 5.2" "Table 5.3" "Table 5.4: where" "Table 5.5"; do
  grep -q "^## $title" tables.md || fail "the tables lack $title"
done
grep -q '^| bender .*| 0\.02 |' tables.md || fail "the tables lack the thesis's times"

# Results of other sources are not gone on with.
echo other >results/sources.txt
gpu_check --out "$PWD/results" --only build || fail "building failed"
grep -q 'what was there is replaced, it is of other sources' log || fail "it goes on with results of other sources"
[[ ! -e results/gpu.csv ]] || fail "rows of other sources stay"
echo "script/gpu-check runs"
