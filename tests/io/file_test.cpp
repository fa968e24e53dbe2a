#include "snell/io/file.h"

#include "image_helpers.h"

#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>

namespace snell {

TEST(File, comes_back_as_written)
{
    TemporaryFolder folder;
    std::string bytes("a\0b\r\n\xff", 6);
    write_atomically(folder / "x", bytes);
    EXPECT_EQ(read_file(folder / "x"), bytes);
    write_atomically(folder / "x", std::string_view());
    EXPECT_EQ(read_file(folder / "x"), "");
    EXPECT_EQ(folder.entries(), 1u);
}

TEST(File, of_unknown_size_is_read_to_its_end)
{
    // The system reports 0 bytes for these.
    EXPECT_GT(read_file("/proc/self/status").size(), 100u);
}

TEST(File, that_cannot_be_read_is_an_error_with_a_reason)
{
    TemporaryFolder folder;
    EXPECT_TRUE(contains(error_of([&] { read_file(folder / "missing"); }), "missing: no such file; check the path"));
    EXPECT_TRUE(contains(error_of([&] { read_file(folder.path()); }), "is a folder"));
    EXPECT_TRUE(contains(error_of([&] { read_file("/dev/zero"); }), "is a device"));
    ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
    EXPECT_TRUE(contains(error_of([&] { read_file(folder / "pipe"); }), "is a device, pipe"));
}

TEST(File, that_cannot_be_written_is_an_error_with_a_reason)
{
    TemporaryFolder folder;
    auto write_to = [&](const fs::path& file) { return error_of([&] { write_atomically(file, "new"); }); };
    EXPECT_TRUE(contains(write_to(folder / "no" / "x"), "does not exist; create it"));
    EXPECT_TRUE(contains(write_to(folder.path()), "is a folder"));
    EXPECT_TRUE(contains(write_to("/dev/null"), "is a device"));
    EXPECT_TRUE(contains(write_to(""), "is not a file's name"));
    EXPECT_TRUE(contains(write_to(folder / std::string(300, 'n')), "cannot be a file's name"));
    put(folder / "file", "");
    EXPECT_TRUE(contains(write_to(folder / "file" / "x"), "does not exist"));
    // /proc takes no new files from anybody, root included.
    EXPECT_TRUE(contains(error_of([&] { check_can_write("/proc/x"); }), "/proc/x: the file cannot be created"));
    EXPECT_EQ(folder.entries(), 1u);
}

TEST(File, survives_a_failed_write)
{
    TemporaryFolder folder;
    put(folder / "x", "old");
    EXPECT_THROW(write_atomically(folder / "x",
                                  [](const fs::path& temporary) {
                                      put(temporary, "half");
                                      throw std::runtime_error("interrupted");
                                  }),
                 std::runtime_error);
    EXPECT_EQ(get(folder / "x"), "old");
    EXPECT_EQ(folder.entries(), 1u);
}

TEST(File, survives_a_full_disk)
{
    TemporaryFolder folder;
    put(folder / "x", "old");
    // A limit on file sizes makes write() fail as a full disk does.
    auto handler = std::signal(SIGXFSZ, SIG_IGN);
    rlimit before = {};
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
    rlimit small = before;
    small.rlim_cur = 1000;
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
    std::string message = error_of([&] { write_atomically(folder / "x", std::string(100000, 'n')); });
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
    std::signal(SIGXFSZ, handler);
    EXPECT_TRUE(contains(message, "writing failed")) << message;
    EXPECT_EQ(get(folder / "x"), "old");
    EXPECT_EQ(folder.entries(), 1u);
}

TEST(File, keeps_permissions_and_follows_links)
{
    TemporaryFolder folder;
    put(folder / "x", "old");
    ASSERT_EQ(chmod((folder / "x").c_str(), 0640), 0);
    fs::create_symlink("x", folder / "link");
    write_atomically(folder / "link", "new");
    EXPECT_TRUE(fs::is_symlink(folder / "link"));
    EXPECT_EQ(get(folder / "x"), "new");
    struct stat info = {};
    ASSERT_EQ(stat((folder / "x").c_str(), &info), 0);
    EXPECT_EQ(info.st_mode & 0777, 0640u);
}

TEST(File, check_can_write_leaves_nothing_behind)
{
    TemporaryFolder folder;
    check_can_write(folder / "x");
    EXPECT_EQ(folder.entries(), 0u);
    EXPECT_TRUE(contains(error_of([&] { check_can_write(folder / "no" / "x"); }), "does not exist"));
    EXPECT_TRUE(contains(error_of([&] { check_can_write(folder.path()); }), "is a folder"));
}

TEST(File, extension_is_in_lower_case)
{
    EXPECT_EQ(lower_extension("a/B.PnG"), ".png");
    EXPECT_EQ(lower_extension("a.b/c"), "");
}

} // namespace snell
