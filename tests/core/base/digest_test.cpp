#include "core/base/digest.h"

#include <gtest/gtest.h>

#include <fstream>

#include "core/base/error.h"
#include "tests/support/temporary_folder.h"

namespace hairbake {
namespace {

// The examples of FIPS 180-2, appendix B, and the empty message.
const std::string empty_digest = "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855";
const std::string abc_digest = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
const std::string two_blocks_digest = "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1";
const std::string million_a_digest = "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0";

TEST(Digest, GivesThePublishedValues) {
    EXPECT_EQ(Digest().hex(), empty_digest);
    EXPECT_EQ(Digest().add("abc").hex(), abc_digest);
    EXPECT_EQ(Digest().add("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq").hex(), two_blocks_digest);
    EXPECT_EQ(Digest().add(std::string(1'000'000, 'a')).hex(), million_a_digest);
}

TEST(Digest, DoesNotDependOnHowTheBytesArePieced) {
    Digest digest;
    for (int i = 0; i < 1000; ++i) digest.add(std::string(1000, 'a')).add("");
    EXPECT_EQ(digest.hex(), million_a_digest);
}

TEST(Digest, MovesWithItsState) {
    Digest first;
    first.add("a");
    Digest second = std::move(first);
    EXPECT_EQ(second.add("bc").hex(), abc_digest);
}

TEST(Digest, ReadsFilesOfAnySize) {
    const test_support::TemporaryFolder folder;
    std::ofstream(folder / "empty").close();
    EXPECT_EQ(digest_of_file(folder / "empty"), empty_digest);
    std::ofstream(folder / "abc") << "abc";
    EXPECT_EQ(digest_of_file(folder / "abc"), abc_digest);
    // Larger than the buffer of 1 MiB, against the same bytes in memory.
    const std::string large(3'000'001, 'x');
    std::ofstream(folder / "large") << large;
    EXPECT_EQ(digest_of_file(folder / "large"), Digest().add(large).hex());
}

TEST(Digest, NamesAFileThatCannotBeRead) {
    const test_support::TemporaryFolder folder;
    for (const std::string name : {"missing", "."}) {
        try {
            digest_of_file(folder / name);
            ADD_FAILURE() << name << " was digested";
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::bad_input);
            EXPECT_NE(std::string(error.what()).find(name), std::string::npos);
        }
    }
}

}  // namespace
}  // namespace hairbake
