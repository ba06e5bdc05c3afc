#!/usr/bin/env bash
# Inside the guest: the real driver. Serve the network on vcan0, look at it with candump, check it with the conformance suite.
set -euo pipefail
speed=$1
.venv/bin/schmidt serve --can socketcan:vcan0 --speed "$speed" >/tmp/serve.log 2>&1 &
server=$!
for _ in $(seq 120); do
    if timeout 3 candump -n 1 vcan0 >/dev/null 2>&1; then break; fi
    kill -0 "$server" || { cat /tmp/serve.log; exit 1; }
done
candump -t a -n 20 vcan0
cansend vcan0 080#11 # an identifier nobody owns: acknowledged and ignored
.venv/bin/schmidt conformance --can socketcan:vcan0 --speed "$speed" --tolerance 0.2 | tail -n 25
status=${PIPESTATUS[0]}
kill -TERM "$server"
wait "$server" || true
tail -n 3 /tmp/serve.log
exit "$status"
