// SPDX-License-Identifier: Apache-2.0
/// Frames of the Mambo's two firmwares: the bytes of tables 5.1 and 5.2 of Oliveira 2020, computed
/// by hand; round trips; rejections.
#include "quadtune/exports/link.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr LinkFirmware kSimulink = LinkFirmware::simulink;
constexpr LinkFirmware kNative = LinkFirmware::native;

std::string hex_of(LinkFirmware firmware, const std::string& name,
                   const std::vector<std::string>& words = {}, std::uint8_t sequence = 0,
                   bool acknowledged = true) {
  LinkCommand command = link_command(firmware, name, words);
  command.sequence = sequence;
  command.acknowledged = acknowledged;
  return link_hex(link_frame(command));
}

template <class Function>
std::string message_of(Function&& function) {
  try {
    (void)function();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "nothing was refused";
}

// The thesis' example is `fwrite(message, [1 power], 'integer*4')` with power = 20.
TEST(SimulinkFrames, AreLittleEndianIntegersOfTable51) {
  EXPECT_EQ(hex_of(kSimulink, "takeoff", {"20"}), "01 00 00 00 14 00 00 00");
  EXPECT_EQ(hex_of(kSimulink, "land"), "02 00 00 00");
  EXPECT_EQ(hex_of(kSimulink, "abort"), "03 00 00 00");
  EXPECT_EQ(hex_of(kSimulink, "read"), "0a 00 00 00");
  // (0 + 10) 1000 = 10000 = 0x2710, (0.05 + 10) 1000 = 10050 = 0x2742, (-0.05 + 10) 1000 = 9950.
  EXPECT_EQ(hex_of(kSimulink, "pitch", {"0"}), "0b 00 00 00 10 27 00 00");
  EXPECT_EQ(hex_of(kSimulink, "roll", {"0.05"}), "0c 00 00 00 42 27 00 00");
  EXPECT_EQ(hex_of(kSimulink, "roll", {"-0.05"}), "0c 00 00 00 de 26 00 00");
  // (3.142 + 10) 1000 = 13142 = 0x3356
  EXPECT_EQ(hex_of(kSimulink, "yaw", {"3.142"}), "0d 00 00 00 56 33 00 00");
  // -0.3 * 100 = -30 = 0xffffffe2: 30 cm above the ground.
  EXPECT_EQ(hex_of(kSimulink, "height", {"-0.3"}), "0e 00 00 00 e2 ff ff ff");
  // 1.5 * 100 = 150 = 0x96, -2 * 100 = -200 = 0xffffff38
  EXPECT_EQ(hex_of(kSimulink, "position", {"1.5", "-2"}), "0f 00 00 00 96 00 00 00 38 ff ff ff");
  EXPECT_EQ(hex_of(kSimulink, "snapshot"), "10 00 00 00");
}

// In the thesis' program, take-off has the number 9, land 10 and a turn of 45 degrees 11.
TEST(NativeFrames, AreThoseOfTable52WithTheirHeader) {
  EXPECT_EQ(hex_of(kNative, "takeoff", {}, 9), "04 0b 09 0b 00 00 00 02 00 01 00");
  EXPECT_EQ(hex_of(kNative, "land", {}, 10), "04 0b 0a 0b 00 00 00 02 00 03 00");
  EXPECT_EQ(hex_of(kNative, "turn", {"45"}, 11), "04 0b 0b 0d 00 00 00 02 04 01 00 2d 00");
  EXPECT_EQ(hex_of(kNative, "turn", {"-90"}, 255), "04 0b ff 0d 00 00 00 02 04 01 00 a6 ff");
  EXPECT_EQ(hex_of(kNative, "flip", {"front"}), "04 0b 00 0f 00 00 00 02 04 00 00 00 00 00 00");
  EXPECT_EQ(hex_of(kNative, "flip", {"left"}), "04 0b 00 0f 00 00 00 02 04 00 00 03 00 00 00");
  EXPECT_EQ(hex_of(kNative, "move", {"10", "-10", "100", "-100"}, 1),
            "04 0b 01 14 00 00 00 02 00 02 00 01 0a f6 64 9c 00 00 00 00");
  EXPECT_EQ(hex_of(kNative, "takeoff", {}, 9, false), "02 0a 09 0b 00 00 00 02 00 01 00");
}

TEST(Ports, AreThoseOfTheTables) {
  EXPECT_EQ(link_port(kSimulink), 12391);
  EXPECT_EQ(link_port(kNative), 6000);
  EXPECT_EQ(link_firmware("simulink"), kSimulink);
  EXPECT_EQ(link_firmware("native"), kNative);
}

TEST(LinkTables, EachStopsAndNoTwoCommandsAreOne) {
  for (const LinkFirmware firmware : {kSimulink, kNative}) {
    std::set<std::uint32_t> ids;
    std::set<std::string> names, stops;
    for (const LinkEntry& entry : link_entries(firmware)) {
      EXPECT_TRUE(ids.insert(entry.id).second) << entry.name;
      EXPECT_TRUE(names.insert(entry.name).second) << entry.name;
      // A stop command must work without further options.
      if (entry.stops) {
        EXPECT_TRUE(entry.arguments.empty()) << entry.name;
        stops.insert(entry.name);
      }
    }
    EXPECT_TRUE(stops.contains("land"));
  }
  EXPECT_TRUE(link_entry(kSimulink, "abort").stops);
}

TEST(LinkFields, AreTheFrameWithWhatTheVehicleReads) {
  LinkCommand turn = link_command(kNative, "turn", {"44.6"});
  turn.sequence = 11;
  const std::vector<LinkField> fields = link_fields(turn);
  std::vector<std::string> names;
  LinkFrame frame;
  for (const LinkField& field : fields) {
    names.push_back(field.name);
    frame.insert(frame.end(), field.bytes.begin(), field.bytes.end());
  }
  EXPECT_THAT(names, ::testing::ElementsAre("type", "buffer", "sequence", "length", "id", "angle"));
  EXPECT_EQ(frame, link_frame(turn));
  EXPECT_EQ(fields[3].value, 13);
  EXPECT_EQ(fields[4].meaning, "turn");
  EXPECT_EQ(fields[5].value, 45);  // rounded to what the frame holds
  EXPECT_EQ(fields[5].unit, "deg");
  EXPECT_EQ(link_fields(link_command(kNative, "flip", {"right"})).back().meaning, "right");
  // No additional rounding: 0.05 is 0.05.
  EXPECT_EQ(link_fields(link_command(kSimulink, "roll", {"0.05"})).back().value, 0.05);
}

// Every command with random values within its limits: decoding restores the values to half a step,
// and the same bytes.
TEST(LinkFrames, ReadBackAsTheyWereWritten) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 5000; ++i) {
    const LinkFirmware firmware = i % 2 == 0 ? kSimulink : kNative;
    const std::vector<LinkEntry>& entries = link_entries(firmware);
    const LinkEntry& entry = entries[random() % entries.size()];
    LinkCommand command{firmware, entry.name, {}};
    for (const LinkArgument& argument : entry.arguments) {
      const double value =
          std::uniform_real_distribution<double>(argument.low, argument.high)(random);
      command.values.push_back(argument.words.empty() ? value : std::round(value));
    }
    if (firmware == kNative) {
      command.sequence = static_cast<std::uint8_t>(random());
      command.acknowledged = random() % 2 == 0;
    }
    const LinkFrame frame = link_frame(command);
    const LinkCommand back = decode_link_frame(firmware, frame);
    EXPECT_EQ(back.name, command.name);
    EXPECT_EQ(back.sequence, command.sequence);
    EXPECT_EQ(back.acknowledged, command.acknowledged);
    ASSERT_EQ(back.values.size(), command.values.size());
    for (std::size_t k = 0; k < back.values.size(); ++k)
      EXPECT_NEAR(back.values[k], command.values[k], 0.5000001 / entry.arguments[k].per_unit);
    EXPECT_EQ(link_frame(back), frame);
    EXPECT_EQ(link_bytes(link_hex(frame)), frame);
  }
}

// Values at the limits are valid.
TEST(LinkFrames, TakeTheirLimits) {
  for (const LinkFirmware firmware : {kSimulink, kNative})
    for (const LinkEntry& entry : link_entries(firmware)) {
      LinkCommand low{firmware, entry.name, {}}, high{firmware, entry.name, {}};
      for (const LinkArgument& argument : entry.arguments) {
        low.values.push_back(argument.low);
        high.values.push_back(argument.high);
      }
      EXPECT_EQ(decode_link_frame(firmware, link_frame(low)).values, low.values);
      EXPECT_EQ(decode_link_frame(firmware, link_frame(high)).values, high.values);
    }
}

// A value that exceeds its limits by one step of the frame, or an infinite one.
TEST(LinkFrames, RefuseValuesBeyondTheirLimits) {
  using Limits = std::numeric_limits<double>;
  for (const LinkFirmware firmware : {kSimulink, kNative})
    for (const LinkEntry& entry : link_entries(firmware))
      for (std::size_t k = 0; k < entry.arguments.size(); ++k) {
        const LinkArgument& argument = entry.arguments[k];
        const double step = 1 / argument.per_unit;
        for (const double bad : {Limits::quiet_NaN(), Limits::infinity(), -Limits::infinity(),
                                 argument.low - step, argument.high + step, 1e300}) {
          LinkCommand command{firmware, entry.name, {}};
          for (const LinkArgument& other : entry.arguments) command.values.push_back(other.low);
          command.values[k] = bad;
          EXPECT_THAT(message_of([&] { return link_frame(command); }),
                      StartsWith(entry.name + ": " + argument.name + " is "))
              << bad;
        }
      }
  EXPECT_EQ(
      message_of([] { return hex_of(kSimulink, "height", {"0.3"}); }),
      "height: z is 0.3 m, expected -10 to 0 m, because z points down, so the ground is 0 and "
      "above it z is negative");
}

TEST(LinkCommands, RefuseWrongWords) {
  const auto refused = [](LinkFirmware firmware, const std::string& name,
                          const std::vector<std::string>& words) {
    return message_of([&] { return link_command(firmware, name, words); });
  };
  EXPECT_EQ(refused(kNative, "takeof", {}),
            "command: 'takeof' is not a command, expected a command of the firmware "
            "native: takeoff, land, move, "
            "turn, flip; did you mean 'takeoff'?");
  EXPECT_THAT(refused(kSimulink, "flip", {"left"}), StartsWith("command: 'flip' is not a command"));
  EXPECT_THAT(refused(kSimulink, "", {}), StartsWith("command: is empty, expected"));
  EXPECT_EQ(
      refused(kNative, "move", {"1"}),
      "move: number of values is 1, expected 4: roll [%], pitch [%], rotation [%], climb [%]");
  EXPECT_EQ(refused(kSimulink, "land", {"1"}), "land: number of values is 1, expected none");
  EXPECT_EQ(refused(kSimulink, "takeoff", {"nan"}),
            "takeoff: power is 'nan', expected a finite number from 0 to 100 %");
  EXPECT_THAT(refused(kSimulink, "takeoff", {"0x10"}), HasSubstr("power is '0x10'"));
  EXPECT_EQ(refused(kNative, "flip", {"frontt"}),
            "flip: direction is 'frontt', expected one of front, back, right, left; did you mean "
            "'front'?");
  EXPECT_THAT(message_of([] { return link_firmware("matlab"); }),
              StartsWith("firmware is 'matlab', expected simulink or native"));
  EXPECT_THAT(message_of([] { return link_firmware(""); }), StartsWith("firmware is missing"));
  // A command that was constructed without link_command().
  EXPECT_THAT(message_of([] {
                return link_frame({kSimulink, "position", {1}});
              }),
              StartsWith("position: number of values is 1, expected 2"));
  EXPECT_THAT(message_of([] {
                return link_frame({kNative, "flip", {0.5}});
              }),
              StartsWith("flip: direction is 0.5, expected 0 to 3"));
}

std::string refused_frame(LinkFirmware firmware, const std::string& hex) {
  return message_of([&] { return decode_link_frame(firmware, link_bytes(hex)); });
}

TEST(DecodeLinkFrame, RefusesFramesOfAnotherLength) {
  EXPECT_EQ(refused_frame(kSimulink, "01 00 00"),
            "frame: has 3 bytes; expected at least 4, because it starts with an id of 4 bytes");
  EXPECT_EQ(refused_frame(kSimulink, "01 00 00 00"),
            "frame: has 4 bytes; expected 8, the length of takeoff");
  EXPECT_EQ(refused_frame(kSimulink, "02 00 00 00 00 00 00 00"),
            "frame: has 8 bytes; expected 4, the length of land");
  EXPECT_EQ(refused_frame(kNative, "04 0b 09 0b 00 00 00 02 00 01"),
            "frame: has 10 bytes; expected at least 11, because it starts with a header of 7 "
            "and an id of 4 bytes");
  EXPECT_EQ(refused_frame(kNative, "04 0b 09 0d 00 00 00 02 00 01 00"),
            "frame: the header states a length of 13 bytes; expected 11, the length of the frame");
  // The header is consistent, but the command is another.
  EXPECT_EQ(refused_frame(kNative, "04 0b 09 0c 00 00 00 02 00 01 00 00"),
            "frame: has 12 bytes; expected 11, the length of takeoff");
  // A length whose upper bytes are not zero.
  EXPECT_THAT(refused_frame(kNative, "04 0b 09 0b 00 00 80 02 00 01 00"),
              StartsWith("frame: the header states a length of 2147483659 bytes"));
}

TEST(DecodeLinkFrame, RefusesWhatIsInNoTable) {
  EXPECT_THAT(refused_frame(kSimulink, "04 00 00 00"),
              StartsWith("frame: the id 04 00 00 00 is not a command of the firmware simulink; "
                         "expected one of 01 00 00 00 (takeoff), 02 00 00 00 (land), "));
  EXPECT_THAT(refused_frame(kSimulink, "00 00 00 01"), HasSubstr("the id 00 00 00 01"));
  EXPECT_THAT(refused_frame(kNative, "04 0b 09 0b 00 00 00 02 00 04 00"),
              StartsWith("frame: the id 02 00 04 00 is not a command of the firmware native"));
  EXPECT_EQ(refused_frame(kNative, "01 8b 00 0b 00 00 00 02 00 01 00"),
            "frame: byte 1, the type, is 01, expected 04 (with acknowledgement) or 02 (without)");
  EXPECT_EQ(refused_frame(kNative, "04 0a 09 0b 00 00 00 02 00 01 00"),
            "frame: byte 2 is 0a, expected 0b, because it is the buffer of the type 04");
  EXPECT_EQ(refused_frame(kNative, "02 0b 09 0b 00 00 00 02 00 01 00"),
            "frame: byte 2 is 0b, expected 0a, because it is the buffer of the type 02");
  const std::string move = "04 0b 01 14 00 00 00 02 00 02 00 ";
  EXPECT_EQ(refused_frame(kNative, move + "00 0a f6 64 9c 00 00 00 00"),
            "frame: byte 12 is 00, expected 01, because it is constant");
  EXPECT_EQ(refused_frame(kNative, move + "01 0a f6 64 9c 00 00 00 07"),
            "frame: byte 20 is 07, expected 00, because it is constant");
}

TEST(DecodeLinkFrame, RefusesValuesBeyondTheirLimits) {
  EXPECT_THAT(refused_frame(kSimulink, "01 00 00 00 65 00 00 00"),
              StartsWith("frame: takeoff: power is 101 %, expected 0 to 100 %"));
  EXPECT_THAT(refused_frame(kSimulink, "0e 00 00 00 1e 00 00 00"),
              StartsWith("frame: height: z is 0.3 m, expected -10 to 0 m"));
  // Without the offset of 10 rad, as if it had been forgotten.
  EXPECT_THAT(refused_frame(kSimulink, "0b 00 00 00 32 00 00 00"),
              StartsWith("frame: pitch: pitch is -9.95 rad"));
  EXPECT_THAT(refused_frame(kSimulink, "0b 00 00 00 00 00 00 80"),
              StartsWith("frame: pitch: pitch is -2147493.648 rad"));
  EXPECT_THAT(refused_frame(kNative, "04 0b 01 14 00 00 00 02 00 02 00 01 80 00 00 00 00 00 00 00"),
              StartsWith("frame: move: roll is -128 %"));
  EXPECT_THAT(refused_frame(kNative, "04 0b 00 0f 00 00 00 02 04 00 00 04 00 00 00"),
              StartsWith("frame: flip: direction is 4, expected 0 to 3"));
}

// Random bytes, and frames with one byte changed, are rejected or decode to a valid command.
TEST(DecodeLinkFrame, TakesNothingThatItWouldNotWrite) {
  std::mt19937_64 random(2);
  std::size_t taken = 0;
  for (int i = 0; i < 20000; ++i) {
    const LinkFirmware firmware = i % 2 == 0 ? kSimulink : kNative;
    LinkFrame frame(random() % 24);
    for (std::uint8_t& byte : frame) byte = static_cast<std::uint8_t>(random() % 32);
    if (i % 3 != 0) {
      const std::vector<LinkEntry>& entries = link_entries(firmware);
      const LinkEntry& entry = entries[random() % entries.size()];
      LinkCommand command{firmware, entry.name, {}};
      for (const LinkArgument& argument : entry.arguments) command.values.push_back(argument.high);
      frame = link_frame(command);
      frame[random() % frame.size()] = static_cast<std::uint8_t>(random());
    }
    try {
      const LinkCommand command = decode_link_frame(firmware, frame);
      EXPECT_EQ(link_frame(command), frame) << link_hex(frame);
      ++taken;
    } catch (const InvalidInput& error) {
      EXPECT_THAT(error.what(), StartsWith("frame: "));
    }
  }
  EXPECT_GT(taken, 100U);
}

// Parrot 2015: type 1, the buffer of the frame plus 128, any sequence number, a length of 8 bytes,
// and the sequence number of the frame.
TEST(Acknowledgements, AreOfOneFrame) {
  const LinkFrame frame = link_bytes("04 0b 09 0b 00 00 00 02 00 01 00");
  EXPECT_TRUE(acknowledges(link_bytes("01 8b 00 08 00 00 00 09"), frame));
  EXPECT_TRUE(acknowledges(link_bytes("01 8b 7f 08 00 00 00 09"), frame));
  for (const char* other :
       {"01 8b 00 08 00 00 00 0a", "02 8b 00 08 00 00 00 09", "01 0b 00 08 00 00 00 09",
        "01 8a 00 08 00 00 00 09", "01 8b 00 09 00 00 00 09", "01 8b 00 08 00 00 00",
        "01 8b 00 08 00 00 00 09 00", "04 0b 09 0b 00 00 00 02 00 01 00"})
    EXPECT_FALSE(acknowledges(link_bytes(other), frame)) << other;
  EXPECT_FALSE(acknowledges({}, frame));
  EXPECT_FALSE(acknowledges(link_bytes("01 8b 00 08 00 00 00 09"), {}));
}

TEST(LinkBytes, ReadWhatThesesAndToolsPrint) {
  const LinkFrame frame = {4, 0x0b, 0xff};
  for (const char* text : {"04 0b ff", "040bff", "0x04 0x0b 0xFF", "  04\t0B\nff "})
    EXPECT_EQ(link_bytes(text), frame) << text;
  for (const char* text : {"4", "04 b", "0g", "0x", "-4", "04,0b", "04 0b f"})
    EXPECT_THAT(message_of([&] { return link_bytes(text); }),
                HasSubstr("expected pairs of hexadecimal digits"))
        << text;
  EXPECT_THAT(message_of([] { return link_bytes(" "); }), StartsWith("frame: is empty"));
}

}  // namespace
}  // namespace quadtune
