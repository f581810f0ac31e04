/// Finding the vendor's library: every way in which it can be missing, and the list of devices.

#include "core/devices/hdapi.h"

#include <gmock/gmock.h>

#include <cstdlib>

#include "core/devices/device_list.h"
#include "tests/core/devices/fake_hd/fake_machine.h"

namespace palpate::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

std::string errorOf(const std::vector<std::string>& names) {
  const hd::LibrarySearch search = hd::findLibrary(names);
  EXPECT_EQ(search.library, nullptr);
  return sentence(hd::libraryError(search));
}

TEST(HdLibrary, TheEnvironmentComesFirst) {
  unsetenv("PALPATE_HD_LIBRARY");
  EXPECT_THAT(hd::libraryCandidates(), ElementsAre("libHD.so", "libHD.so.3.4.0", "libHD.so.3.0.0"));
  setenv("PALPATE_HD_LIBRARY", "/opt/vendor/libHD.so", 1);
  EXPECT_THAT(hd::libraryCandidates(),
              ElementsAre("/opt/vendor/libHD.so", "libHD.so", "libHD.so.3.4.0", "libHD.so.3.0.0"));
  unsetenv("PALPATE_HD_LIBRARY");
}

TEST(HdLibrary, ListsWhatWasTriedWhereNoneIsInstalled) {
  EXPECT_EQ(errorOf({"libHD-absent.so", "libHD-absent.so.3.0.0"}),
            "The Phantom's library could not be loaded. Found: libHD-absent.so: no such file; "
            "libHD-absent.so.3.0.0: no such file. Install the vendor's OpenHaptics library and "
            "device driver, or set PALPATE_HD_LIBRARY to the path of libHD.so; a simulated device "
            "needs neither.");
}

TEST(HdLibrary, NamesTheFunctionThatItLacks) {
  EXPECT_EQ(errorOf({FAKE_HD_INCOMPLETE}),
            std::string("The Phantom's library could not be loaded. Found: ") + FAKE_HD_INCOMPLETE +
                ": it lacks hdCheckCalibration. Install OpenHaptics 3.0 or later.");
}

TEST(HdLibrary, NamesTheLibraryBehindItThatIsMissing) {
  EXPECT_EQ(errorOf({FAKE_HD_DEPENDENT}),
            std::string("The Phantom's library could not be loaded. Found: ") + FAKE_HD_DEPENDENT +
                ": it needs libPhantomIOLib42.so, which is not installed. Install "
                "libPhantomIOLib42.so (part of the vendor's device driver), then try again.");
}

TEST(HdLibrary, NamesTheFunctionThatNoLibraryHas) {
  // Lazily bound it would load, and end the program at its first call.
  EXPECT_EQ(errorOf({FAKE_HD_UNRESOLVED}),
            std::string("The Phantom's library could not be loaded. Found: ") + FAKE_HD_UNRESOLVED +
                ": it needs the function wgetchOfNowhere, which no library here has. Install the "
                "library that has wgetchOfNowhere (for wgetch: ncurses), or name it in "
                "LD_PRELOAD.");
}

TEST(HdLibrary, SaysWhereAFileIsNoLibrary) {
  const std::string error = errorOf({FAKE_HD_NOT_A_LIBRARY});
  EXPECT_THAT(error, HasSubstr("it cannot be loaded ("));
  EXPECT_THAT(error, HasSubstr("Install the vendor's 64-bit library for this system again."));
}

TEST(HdLibrary, TakesTheFirstThatWorksAndLoadsItOnce) {
  const hd::LibrarySearch first =
      hd::findLibrary({"libHD-absent.so", FAKE_HD_INCOMPLETE, FAKE_HD, "libHD-never-tried.so"});
  ASSERT_NE(first.library, nullptr);
  ASSERT_EQ(first.attempts.size(), 3u);
  EXPECT_EQ(first.attempts[0].problem, "no such file");
  EXPECT_EQ(first.attempts[2].problem, "");
  EXPECT_EQ(hd::findLibrary({FAKE_HD}).library, first.library);
  EXPECT_EQ(first.library->path, FAKE_HD);
}

TEST(HdLibrary, ADeviceWithoutALibrarySaysSo) {
  PhantomOptions options;
  options.libraries = {"libHD-absent.so"};
  Phantom phantom(options);
  const auto opened = phantom.open();
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().kind, ErrorKind::Machine);
  EXPECT_EQ(opened.error().message, "The Phantom's library could not be loaded.");
  EXPECT_FALSE(phantom.startServo([](void*) noexcept {}, nullptr));
  EXPECT_EQ(phantom.status().state, hd::DriverState::Closed);
  EXPECT_EQ(phantom.read(7).status, kDeviceLost);
  phantom.close();
}

class DeviceListTest : public FakeMachine {};

TEST_F(DeviceListTest, WithoutALibraryTheSimulatedOnesAreThere) {
  PhantomOptions options;
  options.libraries = {"libHD-absent.so"};
  const DeviceList list = listDevices(options);
  std::vector<std::string> names;
  for (const ListedDevice& one : list.devices) names.push_back(one.name);
  EXPECT_THAT(names, ElementsAre("touch", "touch-x", "premium-6dof", "3d-mouse"));
  EXPECT_THAT(list.library, IsEmpty());
  ASSERT_EQ(list.libraries.size(), 1u);
  EXPECT_EQ(list.libraries[0].name, "libHD-absent.so");
  EXPECT_THAT(librarySentence(list), HasSubstr("libHD-absent.so: no such file"));
}

TEST_F(DeviceListTest, TellsEachPhantomAndWhyAnotherIsNotThereButNoSerialNumber) {
  fake_hd::DeviceSetup left;
  left.name = "Left";
  left.model = "PHANTOM Omni";
  left.serial = "SECRET-4711";
  left.calibration = 0x5002;
  configure(left);
  const DeviceList list = listDevices(options({"Left", "Right"}));
  ASSERT_EQ(list.devices.size(), 6u);
  const ListedDevice& there = list.devices[4];
  EXPECT_EQ(there.name, "phantom:Left");
  EXPECT_TRUE(there.there);
  EXPECT_EQ(there.info.model, "touch");
  EXPECT_EQ(there.firmware, "2.040");
  EXPECT_EQ(there.calibration, "inkwell");
  EXPECT_EQ(there.note, "Put the stylus into the inkwell and leave it there for a second.");
  EXPECT_EQ(there.motorTemperature.size(), 3u);
  const ListedDevice& missing = list.devices[5];
  EXPECT_FALSE(missing.there);
  EXPECT_EQ(missing.note,
            "No Phantom answered. Found: \"Right\": DEVICE_FAULT (0x300, internal 5).");
  EXPECT_THAT(missing.advice, HasSubstr("switched on and plugged in"));
  EXPECT_EQ(librarySentence(list),
            std::string("The Phantom's library was found: ") + FAKE_HD + ".");
  for (const ListedDevice& one : list.devices)
    for (const std::string& text : {one.name, one.note, one.advice, one.firmware, one.vendor,
                                    one.driverVersion, one.info.name})
      EXPECT_THAT(text, Not(HasSubstr("4711")));
  EXPECT_EQ(fake().calls("hdDisableDevice"), 1);  // given back
  EXPECT_EQ(fake().violations(), 0);
}

TEST_F(DeviceListTest, UnderstandsTheNamesOfPhantoms) {
  EXPECT_THAT(phantomOptions("phantom")->names,
              ElementsAre("Default PHANToM", "Default Device", ""));
  EXPECT_THAT(phantomOptions("phantom:Left arm")->names, ElementsAre("Left arm"));
  for (const char* wrong : {"", "touch", "phantom:", "phantoms"}) {
    const auto options = phantomOptions(wrong);
    ASSERT_FALSE(options) << wrong;
    EXPECT_EQ(options.error().kind, ErrorKind::Usage);
  }
}

}  // namespace
}  // namespace palpate::test
