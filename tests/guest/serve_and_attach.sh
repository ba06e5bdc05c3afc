#!/usr/bin/env bash
# Inside the guest: serve the network on vcan0 and /dev/uhid and let other programs attach (attach.py). Usage: serve_and_attach.sh SPEED
set -euo pipefail
.venv/bin/schmidt serve --can socketcan:vcan0 --hid uhid --control 7411 --speed "$1" >/tmp/serve.log 2>&1 &
server=$!
until timeout 5 candump -n 1 vcan0 >/dev/null 2>&1; do
    kill -0 "$server" || { cat /tmp/serve.log; exit 1; }
done
status=0
timeout -k 5 200 .venv/bin/python tests/guest/attach.py 7411 || status=$?
kill -TERM "$server"
wait "$server" || true
tail -n 8 /tmp/serve.log
exit "$status"
