// Bus descriptions, bus maps and recorded logs with one defect each.
#include <doctest/doctest.h>

#include "patella_process.hpp"

using namespace patella::test;

TEST_CASE("a DBC that does not describe a bus") {
  const std::string knee = "BO_ 273 Encoder2: 8 Rig";
  expectRefused({
      {"missing", removed(kDbc), {"patella.dbc: cannot be read"}, {}},
      {"folder", turnedIntoFolder(kDbc), {"patella.dbc: cannot be read"}, {}},
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
      {"missing", removed(kMap), {"can/patella.toml: cannot be opened: No such file"}, {}},
      {"unknown message",
       replaced(kMap, knee, "{ name = \"position_rad.2\", message = \"Encoder9\", signal = \"Position\" },"),
       {"can/patella.toml: ", "position_rad.2", "no message 'Encoder9'", "Encoder2"},
       {}},
      {"unknown signal",
       replaced(kMap, knee, "{ name = \"position_rad.2\", message = \"Encoder2\", signal = \"Angle\" },"),
       {"can/patella.toml: ", "position_rad.2", "no signal 'Angle'", "Position"},
       {}},
      {"unknown input",
       replaced(kMap, knee, "{ name = \"angle_rad.2\", message = \"Encoder2\", signal = \"Position\" },"),
       {"can/patella.toml: ", "'angle_rad.2' is unknown", "position_rad"},
       {}},
      {"input bound twice",
       replaced(kMap, knee, knee + knee),
       {"can/patella.toml: ", "'position_rad.2' is bound twice"},
       {}},
      {"required input not bound",
       replaced(kMap, knee, ""),
       {"can/patella.toml: ", "no signal is bound to input 'position_rad.2'"},
       {}},
      {"joint of another leg",
       replaced(kMap, "position_rad.2", "position_rad.3"),
       {"can/patella.toml: ", "'position_rad.3'", "1 to 2"},
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
       {"can/patella.toml: ", "CRC 'Position'", "'Encoder2'", "one whole byte"},
       {}},
      {"counter that is no counter",
       replaced(kMap, "{ message = \"Emg\", counter = \"Counter\", crc = \"Crc\" },",
                "{ message = \"Emg\", counter = \"Cuonter\", crc = \"Crc\" },"),
       {"can/patella.toml: ", "'Emg'", "'Cuonter'"},
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

TEST_CASE("a log that cannot be replayed") {
  const std::vector<std::string> replay = {"--backend", "replay:{dir}run.log"};
  const std::string line = "(1000000000.000000) can0 110#0000000000000000\n";
  expectRunRefused({
      {"missing", none(), {"run.log: cannot be read"}, replay},
      {"folder", turnedIntoFolder("run.log"), {"run.log: "}, replay},
      {"empty", written("run.log", ""), {"run.log: holds no frame"}, replay},
      {"garbage in line 3",
       written("run.log", line + line + "hello world\n" + line),
       {"run.log:3: ", "'hello'", "expected"},
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
