// Bus descriptions, bus maps and recorded logs with one defect each.
#include <doctest/doctest.h>

#include "tests/integration/malformed/patella_process.hpp"

using namespace patella::test;

TEST_CASE("a DBC that does not describe a bus") {
  const std::string knee = "BO_ 273 Encoder2: 8 Rig";
  expectRefused({
      {"missing", removed(kDbc), {"patella.toml:", ": key 'dbc'", "there is no file", "patella.dbc"}, {}},
      {"folder", turnedIntoFolder(kDbc), {"patella.dbc: is a directory, expected a regular file"}, {}},
      {"empty: no message that the map names", written(kDbc, ""), {"patella.dbc", "Encoder1"}, {}},
      {"syntax", replaced(kDbc, knee, "BO_ 273 Encoder2 8 Rig"), {"patella.dbc:{line}:", "':'"}, {}},
      {"signal outside of its message",
       replaced(kDbc, knee, "BO_ 273 Encoder2: 7 Rig"),
       {"patella.dbc:", "Crc", "Encoder2", "7"},
       {}},
      {"identifier twice",
       replaced(kDbc, knee, "BO_ 272 Encoder2: 8 Rig"),
       {"patella.dbc:", "'Encoder1' and 'Encoder2' share the identifier 0x110"},
       {}},
      {"name twice", replaced(kDbc, knee, "BO_ 273 Encoder1: 8 Rig"), {"patella.dbc:", "Encoder1"}, {}},
      {"identifier too wide",
       replaced(kDbc, knee, "BO_ 4096 Encoder2: 8 Rig"),
       {"patella.dbc:{line}:", "0x1000", "'Encoder2' is wider than 11 bits"},
       {}},
      {"cut off", replaced(kDbc, "SIG_VALTYPE_ 2016 Fu2 : 1;", "SIG_VALTYPE_ 2016"), {"patella.dbc:"}, {}},
  });
}

TEST_CASE("a map from signals to inputs that does not fit") {
  const std::string knee = "{ name = \"position_rad.2\", message = \"Encoder2\", signal = \"Position\" },";
  expectRefused({
      {"missing",
       removed(kMap),
       {"adult.toml:", ": key 'bus.map'", "there is no file", "can/patella.toml"},
       {}},
      {"unknown message",
       replaced(kMap, knee, "{ name = \"position_rad.2\", message = \"Encoder9\", signal = \"Position\" },"),
       {"can/patella.toml:{line}: key 'input[3].message': value 'Encoder9', expected a message of ",
        "'Encoder2'"},
       {}},
      {"unknown signal",
       replaced(kMap, knee, "{ name = \"position_rad.2\", message = \"Encoder2\", signal = \"Angle\" },"),
       {"can/patella.toml:{line}: key 'input[3].signal': value 'Angle', expected a signal of message "
        "'Encoder2': ",
        "'Position'"},
       {}},
      {"unknown input",
       replaced(kMap, knee, "{ name = \"angle_rad.2\", message = \"Encoder2\", signal = \"Position\" },"),
       {"can/patella.toml:{line}: key 'input[3]': input 'angle_rad.2' is unknown", "position_rad"},
       {}},
      {"input bound twice",
       replaced(kMap, knee, knee + knee),
       {"can/patella.toml:{line}: key 'input[4]': input 'position_rad.2' is bound twice",
        "can/patella.toml:{line}: key 'input[3]'"},
       {}},
      {"required input not bound",
       replaced(kMap, knee, ""),
       {"can/patella.toml: ", "no signal is bound to input 'position_rad.2'"},
       {}},
      {"joint of another leg",
       replaced(kMap, "position_rad.2", "position_rad.3"),
       {"can/patella.toml:{line}: key 'input[3]': input 'position_rad.3'", "1 to 2"},
       {}},
      {"velocity of one joint only",
       replaced(kMap, "{ name = \"velocity_rad_s.2\", message = \"Encoder2\", signal = \"Velocity\" },", ""),
       {"can/patella.toml: ", "velocity_rad_s", "expected all or none"},
       {}},
      {"scale of nothing",
       replaced(kMap, knee,
                "{ name = \"position_rad.2\", message = \"Encoder2\", signal = \"Position\", scale = 0 },"),
       {"can/patella.toml:{line}: key 'input[3].scale': value 0, expected a magnitude in [1e-10, 10000]"},
       {}},
      {"CRC that is no byte",
       replaced(kMap, "{ message = \"Encoder2\", counter = \"Counter\", crc = \"Crc\" },",
                "{ message = \"Encoder2\", counter = \"Counter\", crc = \"Position\" },"),
       {"can/patella.toml:8: key 'input[3]': input 'position_rad.2': signal 'Position' of message 'Encoder2' "
        "is "
        "the CRC of its message"},
       {}},
      {"counter that is no counter",
       replaced(kMap, "{ message = \"Emg\", counter = \"Counter\", crc = \"Crc\" },",
                "{ message = \"Emg\", counter = \"Cuonter\", crc = \"Crc\" },"),
       {"can/patella.toml:{line}: key 'protection[4].counter': value 'Cuonter', expected a signal of message "
        "'Emg': ",
        "did you mean 'Counter'?"},
       {}},
      {"command without a torque",
       replaced(kMap, "{ name = \"torque_Nm.2\", signal = \"Torque2\" },", ""),
       {"can/patella.toml: ", "no signal is bound to output 'torque_Nm.2'"},
       {}},
      {"unknown output",
       replaced(kMap, "{ name = \"state\", signal = \"State\" },",
                "{ name = \"mood\", signal = \"State\" },"),
       {"can/patella.toml: ", "'mood' is unknown", "torque_Nm"},
       {}},
      {"timeout of zero",
       replaced(kMap, "encoder_timeout_s = 0.005", "encoder_timeout_s = 0"),
       {"can/patella.toml:{line}: key 'checks.encoder_timeout_s': value 0, expected a number in [5e-04, "
        "0.02]"},
       {}},
      {"position range turned round",
       replaced(kMap, "position_min_rad = -6.3", "position_min_rad = 7"),
       {"can/patella.toml:{line}: key 'checks.position_min_rad': value 7, expected less than", "6.3"},
       {}},
      {"unknown key",
       replaced(kMap, "position_jump_rad = 0.1", "position_jmp_rad = 0.1"),
       {"can/patella.toml:{line}: key 'checks.position_jmp_rad' is unknown",
        "did you mean 'position_jump_rad'"},
       {}},
  });
}

TEST_CASE("one signal for two quantities, or a quantity in another unit than its signal's") {
  const std::string knee = "{ name = \"position_rad.2\", message = \"Encoder2\", signal = \"Position\" },";
  const std::string torque = "{ name = \"torque_Nm.2\", signal = \"Torque2\" },";
  expectRefused({
      {"both joints read one encoder",
       replaced(kMap, knee, "{ name = \"position_rad.2\", message = \"Encoder1\", signal = \"Position\" },"),
       {"can/patella.toml:{line}: key 'input[3]': input 'position_rad.2': reads signal 'Position' of message "
        "'Encoder1' as input 'position_rad.1' (",
        "can/patella.toml:6: key 'input[1]') does; expected a signal of its own"},
       {}},
      {"shared position",
       replaced(
           kMap, knee,
           "{ name = \"position_rad.2\", message = \"Encoder2\", signal = \"Position\", shared = true },"),
       {"can/patella.toml:{line}: key 'input[3]'", "says 'shared', expected that of drive_enabled"},
       {}},
      {"both torques in one signal",
       replaced(kMap, torque, "{ name = \"torque_Nm.2\", signal = \"Torque1\" },"),
       {"can/patella.toml:{line}: key 'command.output[2]': output 'torque_Nm.2': is written to signal "
        "'Torque1'",
        "key 'command.output[1]'"},
       {}},
      {"torque on the counter",
       replaced(kMap, torque, "{ name = \"torque_Nm.2\", signal = \"Counter\" },"),
       {"can/patella.toml:{line}: key 'command.output[2]'", "'Counter'", "is the counter of its message"},
       {}},
      {"feedback from the own command",
       replaced(kMap, "{ name = \"drive_torque_Nm.2\", message = \"DriveStatus\", signal = \"Torque2\" },",
                "{ name = \"drive_torque_Nm.2\", message = \"TorqueCommand\", signal = \"Torque2\" },"),
       {"can/patella.toml:{line}: key 'input[6]'", "is the command that the loop sends"},
       {}},
      {"two protections of one message",
       replaced(kMap, "{ message = \"Emg\", counter = \"Counter\", crc = \"Crc\" },",
                "{ message = \"Encoder1\", crc = \"Crc\" },"),
       {"can/patella.toml:{line}: key 'protection[4]': message 'Encoder1' is protected twice (",
        "key 'protection[1]')"},
       {}},
      {"degrees for radians",
       replaced(kDbc, "Encoder1: 8 Rig\n SG_ Position : 0|24@1- (1E-006,0) [-8.388608|8.388607] \"rad\"",
                "Encoder1: 8 Rig\n SG_ Position : 0|24@1- (1E-006,0) [-8.388608|8.388607] \"deg\""),
       {"can/patella.toml:6: key 'input[1]': input 'position_rad.1'", "is in 'deg' by the DBC",
        "expected 0.0174533 or -0.0174533 to have rad; or 'scale_reason'"},
       {}},
  });
}

TEST_CASE("check tells of messages without protection and of drives that do not report") {
  Workshop workshop;
  workshop.replace(kMap, "  { message = \"Encoder2\", counter = \"Counter\", crc = \"Crc\" },\n", "");
  workshop.replace(kMap, "  { name = \"drive_fault\", message = \"DriveStatus\", signal = \"Fault\" },\n",
                   "");
  const Outcome check = workshop.patella({"check", "--config", workshop.file(kConfig).string()});
  CHECK(check.exit_status == 0);
  INFO(check.output);
  CHECK(
      check.output.find("advice   bus map                 message 'Encoder2' has neither counter nor CRC") !=
      std::string::npos);
  CHECK(check.output.find("no signal is bound to drive_fault") != std::string::npos);
  const Workshop shipped;
  CHECK(shipped.patella({"check", "--config", shipped.file(kConfig).string()}).output.find("bus map") ==
        std::string::npos);
}

TEST_CASE(
    "a log is played to its end, whatever the configuration's duration; of a part that was asked for is "
    "told") {
  Workshop workshop;
  std::string log;
  for (int i = 0; i < 30; ++i)  // 15 s, and the configuration says 12
    log += "(10000000" + std::to_string(10 + i / 2) + (i % 2 == 0 ? ".0" : ".5") +
           "00000) can0 110#0000000000000000\n";
  workshop.write("run.log", log);
  const std::vector<std::string> replay = {"run",
                                           "--config",
                                           workshop.file(kConfig).string(),
                                           "--backend",
                                           "replay:" + workshop.file("run.log").string(),
                                           "--out",
                                           workshop.output().string()};
  const Outcome whole = workshop.patella(replay);
  INFO(whole.output << whole.errors);
  CHECK(whole.exit_status == 0);
  CHECK(workshop.read("out/summary.json").find("\"frames_played\": 30") != std::string::npos);
  CHECK(whole.output.find("frames were played") == std::string::npos);
  std::filesystem::remove_all(workshop.output());
  std::vector<std::string> part = replay;
  part.insert(part.end(), {"--duration", "1"});
  const Outcome some = workshop.patella(part);
  CHECK(some.exit_status == 0);
  CHECK(some.output.find("run.log: only 2 of 30 frames were played; the run ended before the log did") !=
        std::string::npos);
}

TEST_CASE("a log that cannot be replayed") {
  const std::vector<std::string> replay = {"--backend", "replay:{dir}run.log"};
  const std::string line = "(1000000000.000000) can0 110#0000000000000000\n";
  expectRunRefused({
      {"missing", none(), {"run.log: cannot be opened: No such file"}, replay},
      {"folder", turnedIntoFolder("run.log"), {"run.log: is a directory, expected a regular file"}, replay},
      {"empty", written("run.log", ""), {"run.log: holds no frame"}, replay},
      {"garbage in line 3",
       written("run.log", line + line + "hello world\n" + line),
       {"run.log:3: ", "'hello'", "expected"},
       replay},
      {"a stamp of 1970 before all others",
       written("run.log", "(0000000000.000000) can0 110#0000000000000000\n" + line + line),
       {"run.log:2: the stamps jump from 0.000000 to 1000000000.000000, expected at most 60 s forward"},
       replay},
      {"data of odd digits",
       written("run.log", line + "(1000000000.001000) can0 110#123\n"),
       {"run.log:2: ", "expected"},
       replay},
      {"binary", written("run.log", std::string(4096, '\xff')), {"run.log:1: ", "expected"}, replay},
      {"nothing but zero bytes", written("run.log", std::string(512, '\0')), {"run.log:1: "}, replay},
      {"a CSV", written("run.log", "t_s,q1_rad\n0,0.5\n"), {"run.log:1: ", "'t_s,q1_rad'"}, replay},
  });
}
