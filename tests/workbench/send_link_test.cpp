// SPDX-License-Identifier: Apache-2.0
/// Sends commands to a stub of a vehicle on the loopback interface, which checks every byte,
/// acknowledges, drops and delays. Also which addresses are rejected.
#include "quadtune/workbench/link/send_link.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <limits>

#include "quadtune/errors.hpp"
#include "stub_vehicle.hpp"

namespace quadtune {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;
using testing::StubVehicle;
using Bytes = StubVehicle::Bytes;
using Pieces = std::vector<Bytes>;

constexpr LinkFirmware kSimulink = LinkFirmware::simulink;
constexpr LinkFirmware kNative = LinkFirmware::native;

LinkMessage message(LinkFirmware firmware, const std::string& name,
                    const std::vector<std::string>& words,
                    std::optional<std::uint64_t> sequence = std::nullopt,
                    bool acknowledged = true) {
  LinkCommand command = link_command(firmware, name, words);
  command.acknowledged = acknowledged;
  return link_message(command, sequence);
}

LinkMessage native_takeoff() { return message(kNative, "takeoff", {}, 9); }
const Bytes kNativeTakeoff = {4, 0x0b, 9, 0x0b, 0, 0, 0, 2, 0, 1, 0};

Bytes acknowledgement(std::uint8_t number) { return {1, 0x8b, 0, 8, 0, 0, 0, number}; }
using Frames = std::vector<Bytes>;
/// A vehicle that receives everything.
Pieces acknowledged(const Frames& frames) { return {acknowledgement(frames.back()[2])}; }

/// Long enough for any machine: the reply arrives, or the test does not end.
LinkOptions patient() {
  LinkOptions options;
  options.timeout_s = 60;
  return options;
}

/// Many short tries: dropped frames are sent again.
LinkOptions persistent() {
  LinkOptions options;
  options.timeout_s = 0.1;
  options.tries = 100;
  return options;
}

/// For a stub that does not answer.
LinkOptions brief() {
  LinkOptions options;
  options.timeout_s = 0.02;
  return options;
}

LinkTarget to(const StubVehicle& stub, LinkFirmware firmware) {
  return link_target(stub.address(), firmware);
}

template <class Error, class Function>
std::string refusal_of(Function&& function) {
  try {
    function();
  } catch (const Error& error) {
    return error.what();
  }
  return "nothing was refused";
}

// --- firmware simulink: TCP ---

TEST(SendSimulink, SendsEveryByteAndTakesTheAnswer) {
  const StubVehicle stub({.answer = [](const Frames&) { return Pieces{{1, 0, 0, 0}}; }});
  const LinkDelivery delivery =
      send_link(message(kSimulink, "takeoff", {"20"}), to(stub, kSimulink), patient());
  EXPECT_EQ(delivery.status, LinkStatus::answered);
  EXPECT_EQ(delivery.sent, 1U);
  EXPECT_EQ(delivery.reply, (Bytes{1, 0, 0, 0}));
  EXPECT_THAT(stub.frames(), ElementsAre(Bytes{1, 0, 0, 0, 20, 0, 0, 0}));
}

// The reply arrives after the sender has checked several times whether to stop.
TEST(SendSimulink, WaitsForALateAnswer) {
  std::atomic<bool> late{false};
  const StubVehicle stub({.length = 4, .answer = [&](const Frames&) {
                            StubVehicle::wait_for(late);
                            return Pieces{{2}};
                          }});
  LinkOptions options = patient();
  int asked = 0;
  options.interrupted = [&] {
    if (++asked == 5) late = true;
    return false;
  };
  const LinkDelivery delivery =
      send_link(message(kSimulink, "land", {}), to(stub, kSimulink), options);
  EXPECT_EQ(delivery.status, LinkStatus::answered);
  EXPECT_EQ(delivery.reply, Bytes{2});
  EXPECT_THAT(stub.frames(), ElementsAre(Bytes{2, 0, 0, 0}));
}

TEST(SendSimulink, TellsWhatIsNotAnswered) {
  const StubVehicle silent({.length = 4});
  const LinkDelivery delivery =
      send_link(message(kSimulink, "land", {}), to(silent, kSimulink), brief());
  EXPECT_EQ(delivery.status, LinkStatus::unanswered);
  EXPECT_EQ(delivery.sent, 1U);
  EXPECT_THAT(silent.frames(1), ElementsAre(Bytes{2, 0, 0, 0}));
  // A closed connection is not a reply.
  const StubVehicle closing({.length = 4, .answer = [](const Frames&) { return std::nullopt; }});
  EXPECT_EQ(send_link(message(kSimulink, "abort", {}), to(closing, kSimulink), patient()).status,
            LinkStatus::unanswered);
  EXPECT_THAT(closing.frames(1), ElementsAre(Bytes{3, 0, 0, 0}));
}

// A snapshot has no reply, and a frame without a requested acknowledgement has none either.
TEST(SendSimulink, WaitsForNoAnswerWhereNoneIsExpected) {
  const StubVehicle stub({.length = 4});
  EXPECT_EQ(send_link(message(kSimulink, "snapshot", {}), to(stub, kSimulink), patient()).status,
            LinkStatus::sent);
  EXPECT_EQ(
      send_link(message(kSimulink, "land", {}, std::nullopt, false), to(stub, kSimulink), patient())
          .status,
      LinkStatus::sent);
  EXPECT_THAT(stub.frames(2), ElementsAre(Bytes{16, 0, 0, 0}, Bytes{2, 0, 0, 0}));
}

TEST(SendSimulink, NamesTheTargetWhereNobodyListens) {
  const int bound = StubVehicle::bound(SOCK_STREAM, "127.0.0.1");  // and never listens
  const LinkTarget target{"127.0.0.1", StubVehicle::port_of(bound)};
  EXPECT_EQ(refusal_of<FileError>(
                [&] { (void)send_link(message(kSimulink, "land", {}), target, patient()); }),
            to_string(target) + ": Connection refused");
  ::close(bound);
}

// --- native firmware: UDP ---

TEST(SendNative, SendsEveryByteAndTakesTheAcknowledgement) {
  const StubVehicle stub({.type = SOCK_DGRAM, .answer = acknowledged});
  const LinkDelivery delivery = send_link(native_takeoff(), to(stub, kNative), patient());
  EXPECT_EQ(delivery.status, LinkStatus::answered);
  EXPECT_EQ(delivery.sent, 1U);
  EXPECT_EQ(delivery.acknowledged, 1U);
  EXPECT_THAT(stub.frames(), ElementsAre(kNativeTakeoff));
}

TEST(SendNative, SendsTheSameBytesAgainUntilAcknowledged) {
  const StubVehicle stub({.type = SOCK_DGRAM, .answer = [](const Frames& frames) {
                            return frames.size() < 3 ? Pieces{} : Pieces{acknowledgement(9)};
                          }});
  const LinkDelivery delivery = send_link(native_takeoff(), to(stub, kNative), persistent());
  EXPECT_EQ(delivery.status, LinkStatus::answered);
  EXPECT_GE(delivery.sent, 3U);
  EXPECT_THAT(stub.frames(), Each(kNativeTakeoff));
}

// An acknowledgement of the first frame that arrives after the second was sent.
TEST(SendNative, TakesALateAcknowledgementOnce) {
  const StubVehicle stub(
      {.type = SOCK_DGRAM, .answer = [](const Frames& frames) {
         return frames.size() == 1 ? Pieces{} : Pieces{acknowledgement(9), acknowledgement(9)};
       }});
  const LinkDelivery delivery = send_link(native_takeoff(), to(stub, kNative), persistent());
  EXPECT_EQ(delivery.status, LinkStatus::answered);
  EXPECT_EQ(delivery.acknowledged, 1U);
}

// Other frames of the vehicle, which sends many per second, and acknowledgements of other frames.
TEST(SendNative, TakesNothingElseForAnAcknowledgement) {
  const Bytes state = {2, 0x7f, 5, 0x0b, 0, 0, 0, 2, 3, 1, 0};
  Bytes cut = acknowledgement(9);
  cut.pop_back();
  const Pieces others = {{}, {1}, state, cut, kNativeTakeoff, acknowledgement(8), Bytes(2000, 1)};
  const StubVehicle busy(
      {.type = SOCK_DGRAM, .answer = [&](const Frames&) { return Pieces(others); }});
  const LinkDelivery lost = send_link(native_takeoff(), to(busy, kNative), brief());
  EXPECT_EQ(lost.status, LinkStatus::unanswered);
  EXPECT_EQ(lost.acknowledged, 0U);

  Pieces at_last = others;
  at_last.push_back(acknowledgement(9));
  const StubVehicle stub({.type = SOCK_DGRAM, .answer = [&](const Frames&) { return at_last; }});
  EXPECT_EQ(send_link(native_takeoff(), to(stub, kNative), patient()).status, LinkStatus::answered);
}

TEST(SendNative, TakesNoAcknowledgementFromAnotherAddress) {
  const StubVehicle stub({.type = SOCK_DGRAM, .answer = acknowledged, .from = "127.0.0.2"});
  EXPECT_EQ(send_link(native_takeoff(), to(stub, kNative), brief()).status, LinkStatus::unanswered);
}

TEST(SendNative, GivesUpAfterItsTries) {
  const StubVehicle stub({.type = SOCK_DGRAM});
  LinkOptions options = brief();
  options.tries = 4;
  const LinkDelivery delivery = send_link(native_takeoff(), to(stub, kNative), options);
  EXPECT_EQ(delivery.status, LinkStatus::unanswered);
  EXPECT_EQ(delivery.sent, 4U);
  EXPECT_THAT(stub.frames(4), ::testing::AllOf(SizeIs(4), Each(kNativeTakeoff)));
}

TEST(SendNative, SendsOnceWhatAsksForNoAcknowledgement) {
  const StubVehicle stub({.type = SOCK_DGRAM});
  const LinkDelivery delivery =
      send_link(message(kNative, "turn", {"45"}, 11, false), to(stub, kNative), patient());
  EXPECT_EQ(delivery.status, LinkStatus::sent);
  EXPECT_EQ(delivery.sent, 1U);
  EXPECT_THAT(stub.frames(1), ElementsAre(Bytes{2, 0x0a, 11, 0x0d, 0, 0, 0, 2, 4, 1, 0, 45, 0}));
}

// The last number that the vehicle received is unknown: of 256 numbers, one of four that are 64
// apart is 1 to 64 ahead of it.
TEST(SendNative, StopsWithoutANumber) {
  const StubVehicle stub({.type = SOCK_DGRAM, .answer = acknowledged});
  const LinkDelivery delivery =
      send_link(message(kNative, "land", {}), to(stub, kNative), patient());
  EXPECT_EQ(delivery.status, LinkStatus::answered);
  EXPECT_EQ(delivery.acknowledged, 4U);
  std::vector<Bytes> expected;
  for (const std::uint8_t number : Bytes{0, 64, 128, 192})
    expected.push_back({4, 0x0b, number, 0x0b, 0, 0, 0, 2, 0, 3, 0});
  EXPECT_EQ(stub.frames(), expected);
}

// The third is lost.
TEST(SendNative, SendsAgainWhatIsMissing) {
  const Bytes third = {4, 0x0b, 128, 0x0b, 0, 0, 0, 2, 0, 3, 0};
  const auto times = [&](const Frames& frames) {
    return std::count(frames.begin(), frames.end(), third);
  };
  const StubVehicle stub({.type = SOCK_DGRAM, .answer = [&](const Frames& frames) {
                            const bool lost = frames.back() == third && times(frames) == 1;
                            return lost ? Pieces{} : acknowledged(frames);
                          }});
  const LinkDelivery delivery =
      send_link(message(kNative, "land", {}), to(stub, kNative), persistent());
  EXPECT_EQ(delivery.status, LinkStatus::answered);
  EXPECT_EQ(delivery.acknowledged, 4U);
  EXPECT_GE(times(stub.frames()), 2);
}

TEST(SendNative, SendsFromTheGivenPort) {
  const int bound = StubVehicle::bound(SOCK_DGRAM, "127.0.0.1");
  LinkOptions options = brief();
  options.local_port = StubVehicle::port_of(bound);
  const StubVehicle stub({.type = SOCK_DGRAM});
  EXPECT_EQ(
      refusal_of<FileError>([&] { (void)send_link(native_takeoff(), to(stub, kNative), options); }),
      "local port " + std::to_string(options.local_port) + ": Address already in use");
  EXPECT_THAT(stub.frames(), SizeIs(0));
  ::close(bound);
}

// --- interruptions ---

TEST(SendLink, SendsNothingOnceInterrupted) {
  LinkOptions options = patient();
  options.interrupted = [] { return true; };
  const StubVehicle stream({.length = 4}), datagrams({.type = SOCK_DGRAM});
  EXPECT_THROW((void)send_link(message(kSimulink, "land", {}), to(stream, kSimulink), options),
               Interrupted);
  EXPECT_THROW((void)send_link(native_takeoff(), to(datagrams, kNative), options), Interrupted);
  EXPECT_THAT(stream.frames(), SizeIs(0));
  EXPECT_THAT(datagrams.frames(), SizeIs(0));
}

// An interruption of the wait reports that the frame was sent.
TEST(SendLink, TellsWhatWasSentBeforeAnInterruption) {
  const StubVehicle stream({.length = 4}), datagrams({.type = SOCK_DGRAM});
  LinkOptions options = patient();
  options.interrupted = [&] { return !stream.frames().empty(); };
  LinkDelivery delivery = send_link(message(kSimulink, "land", {}), to(stream, kSimulink), options);
  EXPECT_EQ(delivery.status, LinkStatus::interrupted);
  EXPECT_EQ(delivery.sent, 1U);
  options.interrupted = [&] { return !datagrams.frames().empty(); };
  delivery = send_link(native_takeoff(), to(datagrams, kNative), options);
  EXPECT_EQ(delivery.status, LinkStatus::interrupted);
  EXPECT_EQ(delivery.sent, 1U);
}

// --- rejections ---

TEST(LinkTarget, IsOneVehicle) {
  const LinkTarget target = link_target("192.168.3.1:12391", kSimulink);
  EXPECT_EQ(target.host, "192.168.3.1");
  EXPECT_EQ(target.port, 12391);
  EXPECT_EQ(to_string(target), "192.168.3.1:12391");
  EXPECT_EQ(to_string(link_target("127.0.0.1:1", kNative)), "127.0.0.1:1");
}

TEST(LinkTarget, RefusesEverythingElse) {
  const auto refused = [](const std::string& word, LinkFirmware firmware = kNative) {
    return refusal_of<OptionError>([&] { (void)link_target(word, firmware); });
  };
  EXPECT_EQ(
      refused(""),
      "to is missing, expected the address and port of one vehicle, such as 192.168.99.3:6000, "
      "because the vehicle must be named");
  EXPECT_EQ(refused("0.0.0.0:6000"),
            "to is '0.0.0.0:6000', which is the unspecified address, expected the address and port "
            "of one "
            "vehicle, such as 192.168.99.3:6000, because a command is for one vehicle");
  for (const auto& [word, why] : std::vector<std::pair<std::string, std::string>>{
           {"0.1.2.3:6000", "unspecified address"},
           {"255.255.255.255:6000", "received by the whole network"},
           {"192.168.99.255:6000", "received by the whole network"},
           {"192.168.99.0:6000", "denotes a network"},
           {"224.0.0.1:6000", "a multicast address"},
           {"239.255.0.1:6000", "a multicast address"},
           {"240.0.0.1:6000", "reserved"},
           {"192.168.99.3", "there is no default port"},
           {"6000", "there is no default port"},
           {"mambo:6000", "names are not resolved"},
           {"localhost:6000", "names are not resolved"},
           {":6000", "names are not resolved"},
           {"*:6000", "names are not resolved"},
           {"192.168.99:6000", "names are not resolved"},
           {"192.168.099.3:6000", "names are not resolved"},
           {"3232235521:6000", "names are not resolved"},
           {"0x7f000001:6000", "names are not resolved"},
           {" 192.168.99.3:6000", "names are not resolved"},
           {"192.168.99.3 :6000", "names are not resolved"},
           {"192.168.99.3:80:6000", "names are not resolved"},
           {"[::1]:6000", "names are not resolved"},
           {"192.168.99.3:", "from 1 to 65535"},
           {"192.168.99.3:0", "from 1 to 65535"},
           {"192.168.99.3:65536", "from 1 to 65535"},
           {"192.168.99.3:-1", "from 1 to 65535"},
           {"192.168.99.3:+6000", "from 1 to 65535"},
           {"192.168.99.3:6000 ", "from 1 to 65535"},
           {"192.168.99.3:0x10", "from 1 to 65535"},
           {"192.168.99.3:12391", "that of the firmware simulink"}})
    EXPECT_THAT(refused(word), HasSubstr(why)) << word;
  EXPECT_THAT(refused(std::string("127.0.0.1\0:6000", 15)), HasSubstr("names are not resolved"));
  EXPECT_THAT(refused("192.168.3.1:6000", kSimulink), HasSubstr("that of the firmware native"));
}

TEST(LinkMessage, NeedsANumberUnlessItStops) {
  const auto refused = [](LinkFirmware firmware, const std::string& name,
                          std::optional<std::uint64_t> sequence) {
    return refusal_of<OptionError>(
        [&] { (void)link_message(link_command(firmware, name, {}), sequence); });
  };
  EXPECT_EQ(
      refused(kNative, "takeoff", std::nullopt),
      "sequence is missing, expected 0 to 255, one more than in the previous frame, because the "
      "vehicle orders frames by it");
  EXPECT_THAT(refused(kNative, "takeoff", 256), HasSubstr("sequence is 256, expected 0 to 255"));
  EXPECT_THAT(refused(kSimulink, "land", 1), HasSubstr("sequence is 1, but frames"));
  const LinkMessage numbered = message(kNative, "land", {}, 200);
  ASSERT_THAT(numbered.parts, SizeIs(1));
  EXPECT_EQ(numbered.parts[0].sequence, 200);
  EXPECT_THAT(message(kNative, "land", {}).parts, SizeIs(4));
  EXPECT_THAT(message(kSimulink, "abort", {}).parts, SizeIs(1));
}

TEST(LinkOptions, EveryWaitHasAnEnd) {
  const auto refused = [](auto&& change) {
    LinkOptions options;
    change(options);
    return refusal_of<OptionError>([&] { require_valid(options); });
  };
  for (const double timeout : {std::numeric_limits<double>::quiet_NaN(),
                               std::numeric_limits<double>::infinity(), 0.0, -1.0, 60.1})
    EXPECT_THAT(refused([&](LinkOptions& options) { options.timeout_s = timeout; }),
                HasSubstr("expected 0.01 to 60 s"))
        << timeout;
  for (const std::uint64_t tries : {0, 101})
    EXPECT_THAT(refused([&](LinkOptions& options) { options.tries = tries; }),
                HasSubstr("expected 1 to 100"));
  EXPECT_THAT(refused([](LinkOptions& options) { options.local_port = 65536; }),
              HasSubstr("expected 1 to 65535"));
  EXPECT_NO_THROW(require_valid({}));
}

}  // namespace
}  // namespace quadtune
