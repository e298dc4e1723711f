// SPDX-License-Identifier: Apache-2.0
/// quadtune link: frames on the command line, and a stub on the loopback interface that receives
/// them.
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "run_json.hpp"
#include "run_program.hpp"
#include "source_folder.hpp"
#include "stub_vehicle.hpp"
#include "temporary_directory.hpp"

namespace quadtune::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;
using LinkBytes = StubVehicle::Bytes;
using LinkPieces = std::vector<LinkBytes>;

std::vector<std::string> words_of_line(const std::string& line) {
  std::istringstream stream(line);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

/// The output of "link ...", which must end with status 0.
std::string printed(const std::string& line) {
  const ProgramResult result = run_program(words_of_line(line));
  EXPECT_EQ(result.status, 0) << line << "\n" << result.err;
  EXPECT_EQ(result.err, "");
  return result.out;
}

/// Expects a one-line error, no output and no file.
void refused(const std::string& line, int status, const std::string& message,
             const std::string& where) {
  const TemporaryDirectory folder;
  const std::string file = (folder.path() / "out").string();
  std::vector<std::string> args = words_of_line(line);
  const ProgramResult result = run_program(args);
  EXPECT_EQ(result.status, status) << line << "\n" << result.err;
  EXPECT_THAT(result.err, HasSubstr(message)) << line;
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_EQ(result.out, "");
  args.insert(args.end(), {"-o", file, "--json"});
  const ProgramResult json = run_program(args);
  EXPECT_EQ(json.status, status);
  EXPECT_EQ(nlohmann::json::parse(json.out)["error"]["where"], where) << line;
  EXPECT_FALSE(std::filesystem::exists(file)) << line;
}

TEST(LinkEncode, PrintsTheFrameWithItsFields) {
  EXPECT_EQ(printed("link encode height -0.3 --firmware simulink"),
            "command     height, firmware simulink: sets the height reference\n"
            "frame       0e 00 00 00 e2 ff ff ff\n"
            "fields      field  bytes        meaning\n"
            "            id     0e 00 00 00  height\n"
            "            z      e2 ff ff ff  -0.3 m\n");
  EXPECT_THAT(printed("link encode turn 45 --firmware native --sequence 11"),
              HasSubstr("frame       04 0b 0b 0d 00 00 00 02 04 01 00 2d 00\n"));
  EXPECT_THAT(printed("link encode takeoff --firmware native --no-ack"),
              HasSubstr("frame       02 0a 00 0b 00 00 00 02 00 01 00\n"));
}

TEST(LinkDecode, TellsTheSameAsEncode) {
  for (const std::string command :
       {"takeoff 20 --firmware simulink", "land --firmware simulink",
        "position 1.5 -2 --firmware simulink", "move 10 -10 100 -100 --firmware native",
        "flip left --firmware native --no-ack", "turn -90 --firmware native --sequence 255"}) {
    const std::string text = printed("link encode " + command);
    const auto json = run_json(words_of_line("link encode " + command));
    const std::string decode = "link decode " + json["hex"].get<std::string>() + " --firmware " +
                               json["firmware"].get<std::string>();
    EXPECT_EQ(printed(decode), text);
    EXPECT_EQ(run_json(words_of_line(decode)), json);
  }
  EXPECT_EQ(printed("link decode 040b0a0b00000002000300 --firmware native"),
            printed("link decode 04 0b 0a 0b 00 00 00 02 00 03 00 --firmware native"));
}

TEST(LinkEncode, JsonHasEveryField) {
  const auto json = run_json(words_of_line("link encode flip left --firmware native --sequence 3"));
  EXPECT_EQ(json["firmware"], "native");
  EXPECT_EQ(json["command"], "flip");
  EXPECT_EQ(json["hex"], "04 0b 03 0f 00 00 00 02 04 00 00 03 00 00 00");
  ASSERT_THAT(json["fields"], SizeIs(6));
  EXPECT_EQ(json["fields"][5], nlohmann::json({{"name", "direction"},
                                               {"hex", "03 00 00 00"},
                                               {"value", 3},
                                               {"unit", ""},
                                               {"meaning", "left"}}));
}

TEST(Link, RefusesWrongCommandLines) {
  refused("link encode takeoff 20", 2,
          "quadtune link encode: --firmware is missing, expected simulink or native", "--firmware");
  refused("link encode takeoff 20 --firmware simulnk", 2,
          "--firmware is 'simulnk', expected simulink or native, because their frames differ; did "
          "you mean 'simulink'?",
          "--firmware");
  refused("link encode --firmware native", 2,
          "quadtune link encode: command: is empty, expected a command of the firmware "
          "native: "
          "takeoff, land, move, turn, flip",
          "command");
  refused("link encode hight -1 --firmware simulink", 2, "did you mean 'height'?", "command");
  refused("link encode height 0.3 --firmware simulink", 2,
          "quadtune link encode: height: z is 0.3 m, expected -10 to 0 m, because z points down",
          "height");
  refused("link encode height nan --firmware simulink", 2,
          "height: z is 'nan', expected a finite number", "height");
  refused("link encode takeoff 101 --firmware simulink", 2, "power is 101 %, expected 0 to 100 %",
          "takeoff");
  refused("link encode land now --firmware simulink", 2, "number of values is 1, expected none",
          "land");
  refused("link encode land --firmware simulink --sequence 1", 2,
          "--sequence is 1, but frames of the firmware simulink have no sequence number",
          "--sequence");
  refused("link encode land --firmware native --sequence 256", 2,
          "--sequence is 256, expected 0 to 255", "--sequence");
  refused("link encode land --firmware native --sequence -1", 2, "--sequence", "--sequence");
  refused("link", 2, "the second word is missing, expected encode, decode or send", "link");
  refused("link stop", 2, "'stop' is unknown, expected encode, decode or send", "link");
}

TEST(LinkDecode, RefusesWrongFrames) {
  refused("link decode --firmware native", 2, "quadtune link decode: the bytes are missing", "HEX");
  refused("link decode 02 00 00 --firmware simulink", 2,
          "frame: has 3 bytes; expected at least 4, because it starts with an id of 4 bytes",
          "HEX");
  refused("link decode 02 00 00 00 00 --firmware simulink", 2,
          "frame: has 5 bytes; expected 4, the length of land", "HEX");
  refused("link decode 04 0b 09 0c 00 00 00 02 00 01 00 --firmware native", 2,
          "frame: the header states a length of 12 bytes; expected 11", "HEX");
  refused("link decode 01 00 00 00 65 00 00 00 --firmware simulink", 2,
          "frame: takeoff: power is 101 %, expected 0 to 100 %", "HEX");
  refused("link decode xy --firmware native", 2,
          "frame: 'xy' is not a list of bytes; expected pairs", "HEX");
  std::string many = "link decode";
  for (int i = 0; i < 65; ++i) many += " 00";
  refused(many + " --firmware native", 2, "too many arguments", "HEX");
}

TEST(LinkSend, PrintsWithoutSending) {
  const StubVehicle stub({.type = SOCK_DGRAM});
  EXPECT_EQ(printed("link send land --firmware native --dry-run --to " + stub.address()),
            "to          " + stub.address() +
                ", UDP\n"
                "command     land, firmware native: lands\n"
                "frames      04 0b 00 0b 00 00 00 02 00 03 00\n"
                "            04 0b 40 0b 00 00 00 02 00 03 00\n"
                "            04 0b 80 0b 00 00 00 02 00 03 00\n"
                "            04 0b c0 0b 00 00 00 02 00 03 00\n"
                "sent        nothing, because of --dry-run\n");
  const auto json = run_json(words_of_line(
      "link send takeoff --firmware native --sequence 9 --dry-run --to " + stub.address()));
  EXPECT_EQ(json["status"], "dry-run");
  EXPECT_EQ(json["sent"], 0);
  EXPECT_EQ(json["frames"], nlohmann::json::array({"04 0b 09 0b 00 00 00 02 00 01 00"}));
  EXPECT_THAT(stub.frames(), SizeIs(0));
}

TEST(LinkSend, SendsOneFrameOverTcp) {
  const StubVehicle stub({.answer = [](const LinkPieces&) { return LinkPieces{{1, 0, 0, 0}}; }});
  EXPECT_EQ(printed("link send takeoff 20 --firmware simulink --timeout 60 --to " + stub.address()),
            "to          " + stub.address() +
                ", TCP\n"
                "command     takeoff, firmware simulink: turns the motors on\n"
                "frames      01 00 00 00 14 00 00 00\n"
                "sent        1 frame, answered\n"
                "answer      01 00 00 00\n");
  EXPECT_THAT(stub.frames(), ElementsAre(LinkBytes{1, 0, 0, 0, 20, 0, 0, 0}));
}

TEST(LinkSend, SendsAgainOverUdp) {
  const StubVehicle stub(
      {.type = SOCK_DGRAM, .answer = [](const LinkPieces& frames) {
         return frames.size() < 2 ? LinkPieces{} : LinkPieces{{1, 0x8b, 0, 8, 0, 0, 0, 11}};
       }});
  const auto json = run_json(
      words_of_line("link send turn 45 --firmware native --sequence 11 --timeout 0.1 --tries 100 "
                    "--to " +
                    stub.address()));
  EXPECT_EQ(json["status"], "answered");
  EXPECT_EQ(json["transport"], "UDP");
  EXPECT_GE(json["sent"], 2);
  EXPECT_EQ(json["acknowledged"], 1);
  EXPECT_THAT(stub.frames(),
              ::testing::Each(LinkBytes{4, 0x0b, 11, 0x0d, 0, 0, 0, 2, 4, 1, 0, 45, 0}));
}

// The result is printed nevertheless, because the frames have been sent.
TEST(LinkSend, AnswersNoWhereNothingComesBack) {
  const StubVehicle stub({.type = SOCK_DGRAM});
  const std::string line =
      "link send land --firmware native --timeout 0.02 --tries 2 --to " + stub.address();
  const ProgramResult text = run_program(words_of_line(line));
  EXPECT_EQ(text.status, 1);
  EXPECT_EQ(text.err, "link send: " + stub.address() +
                          " did not answer land within 0.02 s in 2 tries; the vehicle may have "
                          "received it, or may still be flying\n");
  EXPECT_THAT(text.out, HasSubstr("sent        8 frames; 0 of 4 acknowledged\n"));
  const ProgramResult json = run_program(words_of_line(line + " --json"));
  EXPECT_EQ(json.status, 1);
  EXPECT_EQ(nlohmann::json::parse(json.out)["status"], "unanswered");
}

TEST(LinkSend, NamesWhatCannotBeReached) {
  const int bound = StubVehicle::bound(SOCK_STREAM, "127.0.0.1");  // a bound socket that never
                                                                   // listens
  const std::string address = "127.0.0.1:" + std::to_string(StubVehicle::port_of(bound));
  refused("link send abort --firmware simulink --to " + address, 5,
          address + ": Connection refused", address);
  ::close(bound);
}

TEST(LinkSend, SendsNowhereByDefault) {
  refused(
      "link send land --firmware simulink", 2,
      "quadtune link send: --to is missing, expected the address and port of one vehicle, such as "
      "192.168.3.1:12391",
      "--to");
  for (const char* to : {"255.255.255.255:6000", "0.0.0.0:6000", "224.0.0.1:6000", "mambo:6000",
                         "192.168.99.255:6000", "192.168.99.3", "192.168.99.3:12391"})
    refused(std::string("link send land --firmware native --to ") + to, 2,
            std::string("--to is '") + to + "'", "--to");
  refused("link send takeoff --firmware native --to 192.168.99.3:6000", 2,
          "--sequence is missing, expected 0 to 255", "--sequence");
  refused("link send land --firmware simulink --to 127.0.0.1:1 --timeout 61", 2,
          "--timeout is 61, expected 0.01 to 60 s", "--timeout");
  refused("link send land --firmware simulink --to 127.0.0.1:1 --timeout nan", 2, "--timeout",
          "--timeout");
  refused("link send land --firmware native --to 127.0.0.1:1 --tries 101", 2,
          "--tries is 101, expected 1 to 100", "--tries");
  refused("link send land --firmware native --to 127.0.0.1:1 --local-port 65536", 2,
          "--local-port is 65536", "--local-port");
}

// The output of `link` is that of docs/cli/link.md.
TEST(LinkPage, IsWhatComes) {
  std::ifstream page(source_folder() + "/docs/cli/link.md");
  const std::string start = "$ quadtune link ";
  std::size_t commands = 0;
  for (std::string line; std::getline(page, line);) {
    if (!line.starts_with(start)) continue;
    std::string expected;
    for (std::string next; std::getline(page, next) && next != "```" && !next.empty();)
      expected += next + "\n";
    EXPECT_EQ(printed(line.substr(std::string("$ quadtune ").size())), expected) << line;
    ++commands;
  }
  EXPECT_EQ(commands, 3U);
}

}  // namespace
}  // namespace quadtune::testing
