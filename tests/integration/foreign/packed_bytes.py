#!/usr/bin/env python3
"""Holds the bytes of our commands, and what we read in reports, against packing by hand: python-can reads the log, struct packs.

    packed_bytes.py PATELLA SOURCE_FOLDER

Each kind of drive runs in virtual time. In each tick the frame that went out has to have the bytes that the makers' descriptions
give for the torque of that tick in ticks.csv; and the angle that a report holds has to be the one that the loop took from it.
"""
import csv
import math
import pathlib
import re
import struct
import subprocess
import sys
import tempfile

try:
    import can
except ImportError:
    LINE = "=" * 90
    print(f"{LINE}\nSKIPPED, nobody else's reader of logs held our bytes against struct: no python-can (package python3-can)\n{LINE}",
          file=sys.stderr)
    sys.exit(77)

POSITION_RAD, VELOCITY_RAD_S, TORQUE_NM = 12.5, 8.0, 144.0  # ranges of the MIT-mode motor
GEAR, RATED_NM, COUNTS = 100, 0.5, 16384                    # CiA 402


def to_raw(value, reach, bits):
    """What a range of ±reach has for the value, in so many bits."""
    return round((min(max(value, -reach), reach) + reach) / (2 * reach) * (2**bits - 1))


def mit_command(torque_nm):
    """Position 16, velocity 12, stiffness 12, damping 12, torque 12 bits, the first one highest."""
    word = to_raw(0, POSITION_RAD, 16) << 48 | to_raw(0, VELOCITY_RAD_S, 12) << 36 | to_raw(torque_nm, TORQUE_NM, 12)
    return struct.pack(">Q", word)


def mit_zero(data):
    """Zero lies between two raw values: either is right."""
    return to_raw(0, POSITION_RAD, 16) - 1 <= data[0] << 8 | data[1] <= to_raw(0, POSITION_RAD, 16) + 1


def mit_angle(data):
    return (data[1] << 8 | data[2]) / (2**16 - 1) * 2 * POSITION_RAD - POSITION_RAD


def odrive_command(torque_nm):
    return struct.pack("<f", torque_nm)


def odrive_angle(data):
    return struct.unpack("<f", data[:4])[0] * 2 * math.pi


def cia402_command(torque_nm, controlword):
    return struct.pack("<Hh", controlword, round(torque_nm / (GEAR * RATED_NM) * 1000))


def cia402_angle(data):
    return struct.unpack("<i", data[4:8])[0] * 2 * math.pi / (GEAR * COUNTS)


MODEL = {
    "mit": "kind = 'mit'\nid = {0}\nmaster_id = 0\nposition_range_rad = 12.5\nvelocity_range_rad_s = 8\ntorque_range_Nm = 144\n"
           "torque_limit_Nm = 144\n",
    "odrive": "kind = 'odrive'\nid = {0}\ntorque_limit_Nm = 144\n",
    "cia402": "kind = 'cia402'\nid = {0}\ntorque_limit_Nm = 144\nrated_torque_Nm = 0.5\ngear = 100\ncounts_per_turn = 16384\n",
}
MAP = {"mit": "mit_mode", "odrive": "odrive_cansimple", "cia402": "cia402"}
COMMANDS = {"mit": (0x001, 0x002), "odrive": (0x02E, 0x04E), "cia402": (0x201, 0x202)}
REPORTS = {"mit": (0x000, 0x000), "odrive": (0x029, 0x049), "cia402": (0x181, 0x182)}
ANGLE = {"mit": mit_angle, "odrive": odrive_angle, "cia402": cia402_angle}


def ranges():
    text = ""
    for motor in (1, 2):
        for message, end in ((f"Motor{motor}Command", ""), ("MotorReply", str(motor))):
            for signal, reach in (("Position", POSITION_RAD), ("Velocity", VELOCITY_RAD_S), ("Torque", TORQUE_NM)):
                text += f"\n[[range]]\nmessage = '{message}'\nsignal = '{signal}{end}'\nminimum = {-reach}\nmaximum = {reach}\n"
    return text


def run(patella, source, kind, folder):
    configuration = source / "firmware_app/config"
    bus_map = (configuration / "can" / f"{MAP[kind]}.toml").read_text()
    bus_map = re.sub(r'"([a-z0-9_]+\.(?:dbc|eds))"', lambda m: f'"{configuration / "can" / m[1]}"', bus_map)
    (folder / "map.toml").write_text(bus_map + (ranges() if kind == "mit" else ""))
    text = (configuration / "adult.toml").read_text()
    text = re.sub(r"^weights = .*$", "", text, flags=re.M)
    text = text.replace('"models/', f'"{configuration}/models/').replace('"can/patella.toml"', '"map.toml"')
    models = "".join(f"[[rig.drive_model]]\n{MODEL[kind].format(node)}" for node in (1, 2))
    (folder / "run.toml").write_text(text.replace("[rig.emg]", models + "[rig.emg]"))
    subprocess.run([patella, "run", "--config", folder / "run.toml", "--clock", "virtual", "--duration", "3", "--out",
                    folder / "run"], check=True, stdout=subprocess.DEVNULL)
    with open(folder / "run/ticks.csv", newline="") as file:
        ticks = list(csv.DictReader(file))
    return ticks, list(can.CanutilsLogReader(folder / "run/frames.log"))


def expected(kind, torque_nm, sent):
    if kind == "mit":
        return mit_command(torque_nm)
    return odrive_command(torque_nm) if kind == "odrive" else cia402_command(torque_nm, struct.unpack_from("<H", sent)[0])


def same(kind, torque_nm, sent):
    """Byte by byte; a torque at half of a step may be rounded either way, as ticks.csv has what was computed."""
    wanted = expected(kind, torque_nm, sent)
    if kind == "mit":
        torque = (sent[6] & 0xF) << 8 | sent[7]
        return abs(torque - (wanted[6] & 0xF) * 256 - wanted[7]) <= (abs(torque_nm) < 0.04) and mit_zero(sent) and \
            sent[4] == 0 and sent[5] == 0 and sent[3] & 0xF == 0 and sent[6] >> 4 == 0
    return bytes(sent) == wanted


def check(kind, joint, ticks, frames):
    """Returns the number of commands and reports held, and what differs."""
    commands = [f for f in frames if f.arbitration_id == COMMANDS[kind][joint]]
    if kind == "mit":
        commands = [f for f in commands if bytes(f.data[:7]) != b"\xff" * 7]
    wrong = [f"tick {i}: {tick[f'tau_cmd{joint + 1}_Nm']} N·m went out as {bytes(f.data).hex()}"
             for i, (tick, f) in enumerate(zip(ticks, commands))
             if not same(kind, float(tick[f"tau_cmd{joint + 1}_Nm"]), f.data)]
    reports = [f for f in frames if f.arbitration_id == REPORTS[kind][joint]]
    if kind == "mit":
        reports = [f for f in reports if f.data[0] == joint + 1]
    angles = {round(ANGLE[kind](f.data), 9) for f in reports}
    taken = [float(tick[f"q{joint + 1}_rad"]) for tick in ticks[100:]]
    wrong += [f"{q} rad was in no report" for q in taken if round(q, 9) not in angles and
              min(abs(q - a) for a in angles) > 2e-9]
    moved = max(taken) - min(taken)
    torque = max(abs(float(tick[f"tau_cmd{joint + 1}_Nm"])) for tick in ticks)
    if len(commands) < len(ticks) or moved < 0.1 or torque < 1:
        wrong.append(f"{len(commands)} commands in {len(ticks)} ticks, {moved} rad, {torque} N·m: nothing was to be seen")
    return len(ticks), len(taken), wrong


def main(patella, source):
    failed = False
    for kind in COMMANDS:
        with tempfile.TemporaryDirectory() as name:
            ticks, frames = run(patella, source, kind, pathlib.Path(name))
        for joint in (0, 1):
            commands, angles, wrong = check(kind, joint, ticks, frames)
            failed = failed or bool(wrong)
            print(f"{'FAILS' if wrong else 'ok   '}  {kind}, joint {joint + 1}: {commands} commands, {angles} angles")
            for line in wrong[:5]:
                print(f"       {line}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], pathlib.Path(sys.argv[2])))
