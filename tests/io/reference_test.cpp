#include "snell/io/reference.h"

#include "snell/core/error.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

namespace fs = std::filesystem;

namespace snell {
namespace {

// A folder "scene" with a texture in a subfolder, and files beside the folder.
class ReferenceTest : public ::testing::Test
{
  protected:
    ReferenceTest()
    {
        std::string name = (fs::temp_directory_path() / "snell_reference_XXXXXX").string();
        if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
        top = fs::canonical(name);
        fs::create_directories(top / "scene" / "textures");
        fs::create_directories(top / "scene2");
        for (const char* file : {"scene/a.gltf", "scene/textures/wood.png", "scene/50%25.png", "scene/back\\slash.png",
                                 "scene2/near.png", "secret.png"})
            std::ofstream(top / file) << "x";
    }
    ~ReferenceTest() override
    {
        std::error_code ignored;
        fs::remove_all(top, ignored);
    }

    fs::path resolve(const std::string& reference, bool sandbox = false, const fs::path& folder = {})
    {
        References references(top / "scene/a.gltf", sandbox, scene);
        return references.resolve(reference, "a.gltf:7: ", folder);
    }
    std::string error_of(const std::string& reference, bool sandbox)
    {
        try {
            resolve(reference, sandbox);
        } catch (const Error& error) {
            return error.what();
        }
        return "no error";
    }

    fs::path top;
    Scene scene;
};

#define EXPECT_SAYS(text, part) EXPECT_NE(std::string(text).find(part), std::string::npos) << (text)

TEST_F(ReferenceTest, InsideNothingIsSaid)
{
    for (const bool sandbox : {false, true}) {
        EXPECT_EQ(resolve("textures/wood.png", sandbox), top / "scene/textures/wood.png");
        EXPECT_TRUE(fs::equivalent(resolve("./textures/../textures//wood.png", sandbox), resolve("textures/wood.png")));
        EXPECT_EQ(resolve("missing/not there.png", sandbox), top / "scene/missing/not there.png");
        EXPECT_EQ(resolve("wood.png", sandbox, top / "scene/textures"), top / "scene/textures/wood.png");
        EXPECT_EQ(resolve("a:b.png", sandbox), top / "scene/a:b.png");
    }
    EXPECT_TRUE(scene.notes.empty());
}

TEST_F(ReferenceTest, PercentSignsAreLeftAlone)
{
    EXPECT_EQ(resolve("50%25.png"), top / "scene/50%25.png");
    EXPECT_EQ(resolve("textures%2fwood.png", true), top / "scene/textures%2fwood.png");
}

TEST_F(ReferenceTest, BackslashesAreSlashesWhereNoSuchFileIs)
{
    EXPECT_EQ(resolve("textures\\wood.png", true), top / "scene/textures/wood.png");
    EXPECT_EQ(resolve("back\\slash.png", true), top / "scene/back\\slash.png");
    EXPECT_SAYS(error_of("..\\secret.png", true), "leads out of the scene's folder");
    EXPECT_EQ(fs::canonical(resolve("..\\secret.png")), top / "secret.png");
}

TEST_F(ReferenceTest, ClimbingOutIsNotedOnceOrRefused)
{
    References references(top / "scene/a.gltf", false, scene);
    for (int i = 0; i < 3; ++i)
        EXPECT_EQ(fs::canonical(references.resolve("../secret.png", "a.gltf:7: ")), top / "secret.png");
    ASSERT_EQ(scene.notes.size(), 1u);
    EXPECT_EQ(scene.notes[0].text, "a.gltf:7: '../secret.png' leads out of the scene's folder; it is followed");

    for (const char* reference : {"../secret.png", "textures/../../secret.png", "../missing.png", "..",
                                  // its name begins with the folder's name
                                  "../scene2/near.png"}) {
        const std::string text = error_of(reference, true);
        EXPECT_SAYS(text, "a.gltf:7: ");
        EXPECT_SAYS(text, reference);
        EXPECT_SAYS(text, "leads out of the scene's folder");
        EXPECT_SAYS(text, "--sandbox");
    }
}

TEST_F(ReferenceTest, AbsolutePathsAreNotedOrRefused)
{
    const std::string secret = (top / "secret.png").string(), wood = (top / "scene/textures/wood.png").string();
    EXPECT_EQ(resolve(secret), secret);
    ASSERT_EQ(scene.notes.size(), 1u);
    EXPECT_SAYS(scene.notes[0].text, "is an absolute path; it is followed");
    for (const std::string& reference : {secret, wood, std::string("C:\\wood.png"), std::string("/proc/self/mem")})
        EXPECT_SAYS(error_of(reference, true), "is an absolute path");
}

TEST_F(ReferenceTest, AbsolutePathsOfAnotherMachineMeanTheFileBesideTheScene)
{
    std::ofstream(top / "scene/bark.png") << "x";
    for (const char* reference : {"C:\\Users\\me\\bark.png", "d:/x/bark.png", "/home/somebody/else/bark.png"}) {
        scene.notes.clear();
        EXPECT_EQ(resolve(reference), top / "scene/bark.png") << reference;
        ASSERT_EQ(scene.notes.size(), 1u);
        EXPECT_EQ(scene.notes[0].kind, Note::Kind::warning);
        EXPECT_SAYS(scene.notes[0].text, "'bark.png' beside the scene is used");
        EXPECT_SAYS(scene.notes[0].text, reference);
    }
}

TEST_F(ReferenceTest, LinksCountAsWhatTheyLeadTo)
{
    fs::create_symlink(top / "secret.png", top / "scene/innocent.png");
    fs::create_directory_symlink(top / "scene2", top / "scene/more");
    fs::create_directory_symlink(top / "scene/textures", top / "scene/alias");
    fs::create_symlink("loop", top / "scene/loop");
    EXPECT_SAYS(error_of("innocent.png", true), "leads out");
    EXPECT_SAYS(error_of("more/near.png", true), "leads out");
    // Out by a link and then "..": back beside the scene's folder, not in it, whatever the text looks like.
    EXPECT_SAYS(error_of("more/../secret.png", true), "leads out");
    EXPECT_SAYS(error_of("loop/x.png", true), "cannot be followed");
    EXPECT_EQ(resolve("alias/wood.png", true), top / "scene/alias/wood.png");
    EXPECT_TRUE(scene.notes.empty());
    resolve("innocent.png");
    EXPECT_EQ(scene.notes.size(), 1u);
}

TEST_F(ReferenceTest, TheSceneMayBeReachedByALink)
{
    fs::create_directory_symlink(top / "scene", top / "link");
    References references(top / "link/a.gltf", true, scene);
    EXPECT_EQ(references.resolve("textures/wood.png", ""), top / "link/textures/wood.png");
    EXPECT_THROW(references.resolve("../secret.png", ""), Error);
}

TEST_F(ReferenceTest, ASceneInTheCurrentFolder)
{
    References references("a.gltf", true, scene);
    EXPECT_EQ(references.resolve("x.png", ""), "x.png");
    EXPECT_THROW(references.resolve("../x.png", ""), Error);
    EXPECT_TRUE(scene.notes.empty());
}

TEST_F(ReferenceTest, NothingIsFetched)
{
    for (const char* reference : {"http://example.org/wood.png", "https://example.org/wood.png", "file:///etc/passwd",
                                  "s3+x://bucket/wood.png"})
        for (const bool sandbox : {false, true}) {
            EXPECT_SAYS(error_of(reference, sandbox), "a.gltf:7: ");
            EXPECT_SAYS(error_of(reference, sandbox), reference);
            EXPECT_SAYS(error_of(reference, sandbox), "fetched");
        }
    EXPECT_SAYS(error_of(std::string("wood.png\0x", 10), false), "zero byte");
}

} // namespace
} // namespace snell
