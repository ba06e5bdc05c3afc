#!/usr/bin/env bash
# Boot a Linux guest with vcan under software emulation and run a command in it, on this machine's own root (9p), for machines
# whose kernel has no SocketCAN. Needs Debian's qemu-system-x86, linux-image-amd64, busybox-static, kmod, cpio, iproute2.
# Usage: boot.sh COMMAND...   Exit status: the command's; 77 when the machine lacks what is needed.
set -euo pipefail
kernel=$(ls /boot/vmlinuz-* 2>/dev/null | sort -V | tail -n 1 || true)
busybox=$(command -v busybox || true)
if [ -z "$kernel" ] || [ -z "$busybox" ] || ! command -v qemu-system-x86_64 >/dev/null; then
    echo "guest: needs qemu-system-x86, linux-image-amd64 and busybox-static" >&2
    exit 77
fi
version=${kernel#/boot/vmlinuz-}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$work/initramfs"/{bin,proc,sys,dev,root,modules}
cp "$busybox" "$work/initramfs/bin/busybox"
# show-depends lists each module after what it needs; the order is kept, doubles dropped.
for module in virtio_pci 9pnet_virtio 9p can can-raw vcan hid hid_generic uhid; do
    modprobe --show-depends -S "$version" "$module" | awk '$1 == "insmod" {print $2}'
done | awk '!seen[$0]++' >"$work/modules"
: >"$work/initramfs/modules/order"
while read -r path; do
    cp "$path" "$work/initramfs/modules/"
    basename "$path" >>"$work/initramfs/modules/order"
done <"$work/modules"
cat >"$work/command" <<EOF
#!/bin/bash
export PATH=$PATH HOME=/tmp PYTHONDONTWRITEBYTECODE=1 NUMBA_CACHE_DIR=/tmp/numba
cd $(printf %q "$PWD")
$(printf '%q ' "$@")
EOF
cat >"$work/initramfs/init" <<EOF
#!/bin/busybox sh
/bin/busybox --install -s /bin
mount -t proc proc /proc; mount -t sysfs sys /sys; mount -t devtmpfs dev /dev
while read -r module; do insmod /modules/\$module; done </modules/order
mount -t 9p -o trans=virtio,version=9p2000.L,msize=512000,cache=loose root /root || echo "guest: no root"
mount -t proc proc /root/proc; mount -t sysfs sys /root/sys; mount --move /dev /root/dev
mount -t tmpfs tmp /root/tmp
mkdir -p /root/tmp/guest
cp /command /root/tmp/guest/command
chroot /root /bin/bash -c 'ip link set lo up; ip link add vcan0 type vcan && ip link set vcan0 up; bash /tmp/guest/command; echo "GUEST-STATUS \$?"'
poweroff -f
EOF
cp "$work/command" "$work/initramfs/command"
chmod +x "$work/initramfs/init"
(cd "$work/initramfs" && find . | cpio -o -H newc --quiet | gzip -1) >"$work/initramfs.gz"
timeout -k 10 "${GUEST_TIMEOUT:-1600}" qemu-system-x86_64 -accel tcg -cpu max -m 2048 -smp 2 -nographic -no-reboot -nic none \
    -kernel "$kernel" -initrd "$work/initramfs.gz" -append "console=ttyS0 quiet panic=-1" \
    -virtfs "local,path=/,mount_tag=root,security_model=none,multidevs=remap" </dev/null | tee "$work/out"
status=$(tr -d '\r' <"$work/out" | awk '$1 == "GUEST-STATUS" {print $2}' | tail -n 1)
exit "${status:-1}"
