# Loop and rig over two SJA1000 controllers (kvaser_pci driver) on one bus: at least five
# frames each way a millisecond. sja1000.sh [SECONDS]
# board: kernel=rt time=counted can=2 limit=3000
. "$PATELLA_SOURCE/tests/board/qemu/with_rig.sh"
modprobe can-raw
modprobe kvaser_pci
for interface in can0 can1; do
  ip link set dev "$interface" type can bitrate 1000000 restart-ms 100
  ip link set dev "$interface" txqueuelen 10 up || fail "$interface could not be brought up"
done
# On this kernel interrupts are threads of priority 50. Below the loop and the rig they would come too late: the
# controller holds no more than five frames.
interrupt_threads() {
  sed -n 's/^\([0-9]*\) (irq\/[0-9]*-can[01]).*/\1/p' /proc/[0-9]*/stat
}
expect "interrupt threads of the controllers" "$(interrupt_threads | wc -l)" -eq 2
for thread in $(interrupt_threads); do
  chrt -f -p 90 "$thread"
done
make_config </dev/null
start_rig can1
# The loop's one frame a tick, and four or more from its node. They come back to the loop, too, as what another process
# of the node has sent.
chrt -f 70 cangen can0 -g 0.05 -I 600 -L 8 -D i &
traffic_pid=$!
run_loop can0 "${1:-5}" --require-rt
kill "$traffic_pid"
stop_rig
require_perfect
require ticks -eq $((${1:-5} * 1000))
require frames_received -ge $((${1:-5} * 8900))
ip -statistics link show can0
expect "frames sent by the loop's node" "$(cat /sys/class/net/can0/statistics/tx_packets)" -ge $((${1:-5} * 5000))
expect "frames sent by the rig's node" "$(cat /sys/class/net/can1/statistics/tx_packets)" -ge $((${1:-5} * 5000))
for name in rx_dropped tx_dropped rx_errors tx_errors; do
  expect "can0 $name" "$(cat /sys/class/net/can0/statistics/$name)" -eq 0
done
finish
