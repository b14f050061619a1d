# `patella check` has nothing to say of a rig that is set up as docs/rig.md tells, and names every setting that is not.
# board: kernel=rt time=counted can=1 isolated=yes limit=900
. "$PATELLA_SOURCE/tests/board/qemu/with_rig.sh"
modprobe can-raw
modprobe kvaser_pci
make_config <"$PATELLA_SOURCE/tests/board/qemu/gpio.toml"
sed -i 's/^cpus = .*/cpus = [1]/; s/^map = .*/&\nbitrate_bit_s = 1000000/' "$config"

# bring_up BITRATE RESTART-MS TXQUEUELEN
bring_up() {
  ip link set can0 down
  ip link set can0 type can bitrate "$1" restart-ms "$2"
  ip link set can0 txqueuelen "$3" up
}
# raise_interrupt PRIORITY: the thread is there anew each time the interface comes up.
raise_interrupt() {
  chrt -f -p "$1" "$(sed -n 's/^\([0-9]*\) (irq\/[0-9]*-can0).*/\1/p' /proc/[0-9]*/stat)"
}
check() {
  status=0
  patella check --config "$config" --backend can:can0 --require-rt >"$PATELLA_ARTEFACTS/check.txt" || status=$?
}
# spoilt NAME STATUS WORD: what check must call the setting now, and its exit status.
spoilt() {
  check
  grep -q "^  $3  *$1 " "$PATELLA_ARTEFACTS/check.txt" ||
    fail "check does not say $3 of $1, but: $(grep " $1 " "$PATELLA_ARTEFACTS/check.txt")"
  expect "exit status of check with $1 spoilt" "$status" -eq "$2"
}

bring_up 1000000 100 10
raise_interrupt 85
check
cat "$PATELLA_ARTEFACTS/check.txt"
expect "exit status of check" "$status" -eq 0
for name in preempt_rt rtprio_limit memlock_limit governor processors isolated_cpus nohz_full cpu_dma_latency sched_rt_runtime_us \
    swap clock_source irq_affinity can_up can_state can_bitrate can_restart_ms can_txqueuelen can_irq_priority gpio_chip; do
  grep -q "^  ok  *$name " "$PATELLA_ARTEFACTS/check.txt" || fail "check does not say ok of $name"
done
cp "$PATELLA_ARTEFACTS/check.txt" "$PATELLA_ARTEFACTS/all_well.txt"

bring_up 500000 100 10
spoilt can_bitrate 1 MISSING
bring_up 1000000 0 10
spoilt can_restart_ms 0 advice
bring_up 1000000 100 1000
spoilt can_txqueuelen 1 MISSING
bring_up 1000000 100 10
raise_interrupt 50
spoilt can_irq_priority 0 advice
ip link set can0 down
spoilt can_up 1 MISSING
bring_up 1000000 100 10
sed -i 's/^cpus = .*/cpus = [0]/' "$config"
spoilt isolated_cpus 0 advice
spoilt irq_affinity 0 advice
sed -i 's/^cpus = .*/cpus = [1]/; s/^chip = .*/chip = "gpiochip7"/' "$config"
spoilt gpio_chip 1 MISSING
finish
