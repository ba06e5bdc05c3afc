#!/usr/bin/env bash
# Inside the guest: the real driver. Serve the network on vcan0, look at it with candump, check it with the conformance suite.
# Usage: serve_and_check.sh SPEED...   The guest's processor is emulated: a speed it cannot hold fails the periods, so the next,
# slower one is tried. Its time stamps are as uncertain as the slices of an emulated processor are long
# (--stamps). Exit status 0 when one speed passes every check.
set -euo pipefail
for speed in "$@"; do
    .venv/bin/schmidt serve --can socketcan:vcan0 --speed "$speed" >/tmp/serve.log 2>&1 &
    server=$!
    until timeout 5 candump -n 1 vcan0 >/dev/null 2>&1; do
        kill -0 "$server" || { cat /tmp/serve.log; exit 1; }
    done
    candump -t a -n 20 vcan0
    status=0
    .venv/bin/schmidt conformance --can socketcan:vcan0 --speed "$speed" --tolerance 0.2 --stamps 1 >/tmp/checks || status=$?
    tail -n 25 /tmp/checks
    kill -TERM "$server"
    wait "$server" || true
    tail -n 3 /tmp/serve.log
    [ "$status" = 0 ] && exit 0
done
exit 1
