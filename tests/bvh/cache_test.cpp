// Trees come back from their files bit for bit, and nothing else ever does.
#include "snell/bvh/cache.h"
#include "snell/bvh/primitives.h"
#include "snell/bvh/tree_file.h"
#include "snell/core/error.h"
#include "snell/core/parallel.h"
#include "tests/bvh/cache_scenes.h"
#include "tests/bvh/tree_checks.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <thread>

#include <spawn.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace snell::test {
namespace {

namespace fs = std::filesystem;

// A folder of its own for each test, empty at first and gone afterwards.
class TreeCacheTest : public ::testing::Test
{
  protected:
    void SetUp() override
    {
        const char* scratch = std::getenv("TEST_TMPDIR");
        folder_ = fs::path(scratch != nullptr ? scratch : fs::temp_directory_path()) /
                  fmt::format("tree_cache_{}_{}", ::getpid(),
                              ::testing::UnitTest::GetInstance()->current_test_info()->name());
        fs::remove_all(folder_);
        cache_.folder = folder_ / "trees";
        cache_.least_references = 1;
    }
    void TearDown() override { fs::remove_all(folder_); }

    // Builds or loads, and tells which.
    CacheUse use(const PackedScene& scene, const std::vector<PrimitiveRef>& refs, const BuildOptions& options = {})
    {
        CacheUse count;
        tree_ = build_cached(scene, refs, options, cache_, &count);
        return count;
    }

    std::vector<fs::path> files() const
    {
        std::vector<fs::path> found;
        for (const fs::directory_entry& entry : fs::directory_iterator(cache_.folder)) found.push_back(entry.path());
        std::sort(found.begin(), found.end());
        return found;
    }
    fs::path only_file() const
    {
        EXPECT_EQ(files().size(), 1u);
        return files().front();
    }

    fs::path folder_;
    TreeCache cache_;
    BinaryTree tree_;
};

std::string contents(const fs::path& file)
{
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

void write(const fs::path& file, const std::string& bytes)
{
    std::ofstream(file, std::ios::binary) << bytes;
}

void put_byte(const fs::path& file, std::size_t at, char byte)
{
    std::fstream out(file, std::ios::binary | std::ios::in | std::ios::out);
    out.seekp(static_cast<std::streamoff>(at));
    out.put(byte);
}

bool same_use(const CacheUse& use, std::size_t loaded, std::size_t built, std::size_t refused)
{
    return use.loaded == loaded && use.built == built && use.refused == refused;
}

TEST_F(TreeCacheTest, RoundTripBitForBit)
{
    std::vector<PrimitiveRef> mixed_refs;
    const PackedScene mixed = mixture(mixed_refs);
    const PackedScene one = soup(1), many = soup(3000);
    const std::pair<const PackedScene*, std::vector<PrimitiveRef>> cases[] = {
        {&mixed, mixed_refs},
        {&one, collect_primitives(one, one.world)},
        {&many, collect_primitives(many, many.world)},
    };
    for (const BuilderInfo& builder : builders())
        for (const uint rounds : {0u, 2u})
            for (const auto& [scene, refs] : cases) {
                SCOPED_TRACE(fmt::format("{}, {} rounds, {} references", builder.name, rounds, refs.size()));
                const BuildOptions options = {std::string(builder.name), 0.5, rounds};
                const BinaryTree built = build_tree(*scene, refs, options);
                EXPECT_TRUE(same_use(use(*scene, refs, options), 0, 1, 0));
                EXPECT_TRUE(same_tree(tree_, built));
                EXPECT_TRUE(same_use(use(*scene, refs, options), 1, 0, 0)) << "its own tree was refused";
                EXPECT_TRUE(same_tree(tree_, built));
            }
    // The default builder goes by its name as well.
    EXPECT_TRUE(same_use(use(many, cases[2].second), 0, 1, 0));
    EXPECT_TRUE(same_use(use(many, cases[2].second, {std::string(builders().front().name)}), 1, 0, 0));
}

TEST_F(TreeCacheTest, EverythingIsInTheKey)
{
    PackedScene scene = soup(40);
    std::vector<PrimitiveRef> refs = collect_primitives(scene, scene.world);
    const Hash128 key = tree_key(scene, refs, {});
    set_thread_count(1);
    EXPECT_EQ(tree_key(scene, refs, {}), key);
    set_thread_count(0);
    EXPECT_NE(tree_key(scene, refs, {"sbvh", 0.25, 0}), key);
    EXPECT_NE(tree_key(scene, refs, {"", 0.26, 0}), key);
    EXPECT_NE(tree_key(scene, refs, {"", 0.25, 1}), key);
    EXPECT_NE(tree_key(scene, std::span(refs).first(39), {}), key);
    for (PrimitiveRef& ref : refs) {
        const PrimitiveRef before = ref;
        for (const auto& change : {+[](PrimitiveRef& r) { r.lower.x = std::nextafter(r.lower.x, -9.0f); },
                                   +[](PrimitiveRef& r) { r.upper.z = std::nextafter(r.upper.z, 9.0f); },
                                   +[](PrimitiveRef& r) { r.kind = RefKind::sphere; }}) {
            change(ref);
            EXPECT_NE(tree_key(scene, refs, {}), key);
            ref = before;
        }
    }
    std::swap(refs[0].index, refs[1].index);
    EXPECT_NE(tree_key(scene, refs, {}), key);
    std::swap(refs[0].index, refs[1].index);
    // A vertex within the same bounds: builders that split see it.
    vec3& vertex = scene.positions[4];
    const vec3 kept = vertex;
    vertex = 0.5f * (vertex + scene.positions[3]);
    EXPECT_NE(tree_key(scene, refs, {}), key);
    vertex = kept;
    EXPECT_EQ(tree_key(scene, refs, {}), key);
}

TEST_F(TreeCacheTest, DamagedFilesAreBuiltAnew)
{
    const PackedScene scene = soup(23);
    const std::vector<PrimitiveRef> refs = collect_primitives(scene, scene.world);
    ASSERT_TRUE(same_use(use(scene, refs), 0, 1, 0));
    const BinaryTree built = tree_;
    const fs::path file = only_file();
    const std::string good = contents(file);
    const Hash128 key = tree_key(scene, refs, {});
    ASSERT_EQ(read_tree_file(file, key, refs.size()).state, TreeFileState::good);
    ASSERT_LT(good.size(), 2000u);

    // Rebuilding waits for the disk, so not all that is refused is rebuilt here.
    const auto expect_refused = [&](bool rebuild) {
        ASSERT_EQ(read_tree_file(file, key, 2 * refs.size()).state, TreeFileState::refused);
        if (!rebuild) return;
        ASSERT_TRUE(same_use(use(scene, refs), 0, 1, 1));
        ASSERT_TRUE(same_tree(tree_, built));
        ASSERT_EQ(contents(file), good) << "not replaced";
    };
    for (std::size_t at = 0; at < good.size(); ++at)
        for (const int change : {0x01, 0x80, 0xff}) {
            SCOPED_TRACE(fmt::format("byte {} xor {}", at, change));
            put_byte(file, at, static_cast<char>(good[at] ^ change));
            expect_refused(at % 61 == 0 && change == 0x01);
            put_byte(file, at, good[at]);
        }
    for (std::size_t size = good.size(); size-- > 0;) {
        SCOPED_TRACE(fmt::format("cut to {}", size));
        fs::resize_file(file, size);
        expect_refused(size % 101 == 0);
    }
    for (const std::string& bytes : {good + '\0', good + good, std::string("Dear diary, ...")}) {
        write(file, bytes);
        expect_refused(true);
    }
    EXPECT_EQ(files().size(), 1u) << "temporary files were left";
    EXPECT_TRUE(same_use(use(scene, refs), 1, 0, 0));
}

// A tree that is sound, and in a file that is whole, but of something else.
TEST_F(TreeCacheTest, FilesOfOtherTreesAreBuiltAnew)
{
    const PackedScene scene = soup(23), other = soup(23, 5);
    const std::vector<PrimitiveRef> refs = collect_primitives(scene, scene.world);
    const std::vector<PrimitiveRef> other_refs = collect_primitives(other, other.world);
    use(scene, refs);
    const fs::path file = only_file();
    use(other, other_refs);
    ASSERT_EQ(files().size(), 2u);
    const fs::path other_file = files()[files()[0] == file ? 1 : 0];
    fs::copy_file(other_file, file, fs::copy_options::overwrite_existing);
    EXPECT_TRUE(same_use(use(scene, refs), 0, 1, 1));

    // Even with the right key in it: somebody else's boxes do not hold these triangles.
    const Hash128 key = tree_key(scene, refs, {});
    write_tree_file(file, key, make_stored(build_tree(other, other_refs, {}), other_refs));
    EXPECT_EQ(read_tree_file(file, key, refs.size()).state, TreeFileState::good);
    EXPECT_TRUE(same_use(use(scene, refs), 0, 1, 1));
    EXPECT_TRUE(same_use(use(scene, refs), 1, 0, 0));

    // Not files at all. A folder cannot be replaced, and that is said.
    fs::remove(file);
    ASSERT_EQ(::mkfifo(file.c_str(), 0600), 0);
    EXPECT_THROW(use(scene, refs), Error);
    fs::remove(file);
    fs::create_directory(file);
    EXPECT_EQ(read_tree_file(file, key, refs.size()).state, TreeFileState::refused);
    EXPECT_THROW(use(scene, refs), Error);
    fs::remove(file);
    fs::create_symlink(other_file, file);
    EXPECT_TRUE(same_use(use(scene, refs), 0, 1, 1));
}

TEST_F(TreeCacheTest, ForgedFilesAreBuiltAnew)
{
    const PackedScene scene = soup(100);
    const std::vector<PrimitiveRef> refs = collect_primitives(scene, scene.world);
    use(scene, refs);
    const BinaryTree built = tree_;
    const Hash128 key = tree_key(scene, refs, {});
    StoredTree forged = make_stored(built, refs);
    forged.nodes[0].link = none;
    write_tree_file(only_file(), key, forged);
    ASSERT_EQ(read_tree_file(only_file(), key, refs.size()).state, TreeFileState::good);
    EXPECT_TRUE(same_use(use(scene, refs), 0, 1, 1));
    EXPECT_TRUE(same_tree(tree_, built));
    EXPECT_TRUE(same_use(use(scene, refs), 1, 0, 0));

    // More than there can be: refused by its size, before memory is taken.
    forged.order.resize(1000);
    write_tree_file(only_file(), key, forged);
    EXPECT_EQ(read_tree_file(only_file(), key, 999).state, TreeFileState::refused);
    EXPECT_EQ(read_tree_file(only_file(), key, 1000).state, TreeFileState::good);
}

TEST_F(TreeCacheTest, FoldersThatCannotBeWritten)
{
    const PackedScene scene = soup(50);
    const std::vector<PrimitiveRef> refs = collect_primitives(scene, scene.world);
    fs::create_directories(folder_);
    write(folder_ / "file", "not a folder");
    for (const fs::path& bad : {folder_ / "file", folder_ / "file" / "below", fs::path("/proc/snell-trees")}) {
        cache_.folder = bad;
        try {
            use(scene, refs);
            FAIL() << bad;
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find(bad.string()), std::string::npos) << error.what();
        }
    }
    // Folders are made, all the way.
    cache_.folder = folder_ / "a" / "b" / "c";
    EXPECT_TRUE(same_use(use(scene, refs), 0, 1, 0));
    // No folder, no cache; and small trees are not worth a file.
    cache_.least_references = 51;
    EXPECT_TRUE(same_use(use(scene, refs), 0, 0, 0));
    cache_ = {};
    EXPECT_TRUE(same_use(use(scene, refs), 0, 0, 0));
    EXPECT_TRUE(same_tree(tree_, build_tree(scene, refs, {})));
}

TEST_F(TreeCacheTest, OldestFilesGoFirst)
{
    const auto refs_of = [](const PackedScene& scene) { return collect_primitives(scene, scene.world); };
    std::vector<PackedScene> scenes;
    for (uint i = 0; i < 4; ++i) scenes.push_back(soup(100, i));
    use(scenes[0], refs_of(scenes[0]));
    const std::uint64_t bytes = fs::file_size(only_file());
    use(scenes[1], refs_of(scenes[1]));
    // Both are of the past, the second one the older.
    const auto now = fs::file_time_type::clock::now();
    for (const fs::path& file : files()) fs::last_write_time(file, now - std::chrono::hours(50));
    write(cache_.folder / "notes.txt", std::string(100'000, 'x')); // not ours
    write(cache_.folder / ".snell-1-1.tmp", "left by a program that was killed");
    fs::last_write_time(cache_.folder / ".snell-1-1.tmp", now - std::chrono::hours(25));
    write(cache_.folder / ".snell-1-2.tmp", "somebody is just writing this");
    EXPECT_TRUE(same_use(use(scenes[0], refs_of(scenes[0])), 1, 0, 0)); // used now

    cache_.most_bytes = bytes * 5 / 2; // room for two
    EXPECT_TRUE(same_use(use(scenes[2], refs_of(scenes[2])), 0, 1, 0));
    EXPECT_EQ(files().size(), 4u);
    EXPECT_TRUE(fs::exists(cache_.folder / "notes.txt"));
    EXPECT_FALSE(fs::exists(cache_.folder / ".snell-1-1.tmp"));
    EXPECT_TRUE(fs::exists(cache_.folder / ".snell-1-2.tmp"));
    EXPECT_TRUE(same_use(use(scenes[0], refs_of(scenes[0])), 1, 0, 0));
    EXPECT_TRUE(same_use(use(scenes[2], refs_of(scenes[2])), 1, 0, 0));
    cache_.most_bytes = 0; // the newest one stays, whatever the limit
    EXPECT_TRUE(same_use(use(scenes[3], refs_of(scenes[3])), 0, 1, 0));
    EXPECT_TRUE(same_use(use(scenes[3], refs_of(scenes[3])), 1, 0, 0));
    EXPECT_EQ(files().size(), 3u);
}

// Everybody writes the same files and damages them, all the time; nobody ever gets a wrong tree.
void hammer(const TreeCache& cache, uint seed, int rounds)
{
    Random random(seed);
    for (int i = 0; i < rounds; ++i) {
        const PackedScene scene = soup(60, static_cast<uint>(random.bits() % 3));
        const std::vector<PrimitiveRef> refs = collect_primitives(scene, scene.world);
        CacheUse count;
        const BinaryTree tree = build_cached(scene, refs, {}, cache, &count);
        ASSERT_EQ(count.loaded + count.built, 1u);
        ASSERT_TRUE(same_tree(tree, build_tree(scene, refs, {})));
        if (random.bits() % 3 != 0) continue;
        const fs::path file = cache.folder / (to_hex(tree_key(scene, refs, {})) + ".snelltree");
        put_byte(file, random.bits() % 800, '!');
    }
}

TEST_F(TreeCacheTest, ManyThreadsAtOnce)
{
    std::vector<std::thread> threads;
    for (uint i = 0; i < 4; ++i) threads.emplace_back([&, i] { hammer(cache_, i, 25); });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(files().size(), 3u);
}

// In the folder that the test below names, or one of its own.
TEST_F(TreeCacheTest, OneOfManyPrograms)
{
    if (const char* shared = std::getenv("SNELL_TEST_TREE_FOLDER")) cache_.folder = shared;
    hammer(cache_, static_cast<uint>(::getpid()), 15);
    EXPECT_GE(files().size(), 1u);
}

TEST_F(TreeCacheTest, ManyProgramsAtOnce)
{
    fs::create_directories(cache_.folder);
    ::setenv("SNELL_TEST_TREE_FOLDER", cache_.folder.c_str(), 1);
    ::setenv("GTEST_OUTPUT", "", 1);
    std::string program = "/proc/self/exe", filter = "--gtest_filter=TreeCacheTest.OneOfManyPrograms";
    char* arguments[] = {program.data(), filter.data(), nullptr};
    std::vector<pid_t> programs;
    for (int i = 0; i < 3; ++i) {
        pid_t program_id = 0;
        ASSERT_EQ(::posix_spawn(&program_id, program.c_str(), nullptr, nullptr, arguments, environ), 0);
        programs.push_back(program_id);
    }
    hammer(cache_, 1, 15);
    for (const pid_t program_id : programs) {
        int status = -1;
        ::waitpid(program_id, &status, 0);
        EXPECT_EQ(status, 0);
    }
    ::unsetenv("SNELL_TEST_TREE_FOLDER");
    EXPECT_EQ(files().size(), 3u);
}

} // namespace
} // namespace snell::test
