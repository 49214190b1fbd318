// Errors keep the number of the system's error, by which the service tells a trouble of the machine from a bad file.
#include <gtest/gtest.h>

#include <cerrno>
#include <fstream>

#include "core/base/digest.h"
#include "core/base/naming_file.h"
#include "core/environment/environment_reader.h"
#include "core/hair/hair_file.h"
#include "core/mesh/mesh_file.h"
#include "core/output/file_sink.h"
#include "core/output/result_folder.h"
#include "tests/support/temporary_folder.h"

namespace hairbake {
namespace {

template <class Body>
int system_error_of(const Body& body) {
    try {
        body();
    } catch (const Error& error) {
        return error.system_error();
    }
    ADD_FAILURE() << "no Error was thrown";
    return -1;
}

class SystemError : public ::testing::Test {
protected:
    test_support::TemporaryFolder folder;
    Progress progress;
};

TEST_F(SystemError, OfAFileThatIsMissingIsKeptByEveryReader) {
    const std::filesystem::path file = folder / "missing";
    EXPECT_EQ(system_error_of([&] { digest_of_file(file); }), ENOENT);
    EXPECT_EQ(system_error_of([&] { read_groom(file); }), ENOENT);
    EXPECT_EQ(system_error_of([&] { is_hair_file(file); }), ENOENT);
    EXPECT_EQ(system_error_of([&] { read_mesh(file); }), ENOENT);
    EXPECT_EQ(system_error_of([&] { read_environment(file.string(), {}, progress); }), ENOENT);
    EXPECT_EQ(system_error_of([&] { naming_file("x", [&] { digest_of_file(file); }); }), ENOENT);
}

TEST_F(SystemError, OfAFolderInPlaceOfAFileIsKept) {
    EXPECT_EQ(system_error_of([&] { digest_of_file(folder / "."); }), EISDIR);
}

TEST_F(SystemError, OfAFileThatCannotBeWrittenIsKept) {
    EXPECT_EQ(system_error_of([&] { FileSink(folder / "no folder/file"); }), ENOENT);
    FileSink(folder / "file").finish();
    EXPECT_EQ(system_error_of([&] { FileSink(folder / "file"); }), EEXIST);
    EXPECT_EQ(system_error_of([&] { ResultFolder(folder / "file/result"); }), ENOTDIR);
}

TEST_F(SystemError, OfAFileThatIsReadAndBrokenIsNone) {
    const std::filesystem::path file = folder / "broken.obj";
    std::ofstream(file) << "f 1 2 3\n";
    EXPECT_EQ(system_error_of([&] { read_groom(file); }), 0);
    EXPECT_EQ(system_error_of([&] { read_mesh(file); }), 0);
    EXPECT_EQ(system_error_of([&] { read_environment(file.string(), {}, progress); }), 0);
}

}  // namespace
}  // namespace hairbake
