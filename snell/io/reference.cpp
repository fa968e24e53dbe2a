#include "snell/io/reference.h"

#include "snell/core/error.h"

#include <algorithm>
#include <cctype>

namespace fs = std::filesystem;

namespace snell {

// Without links, "." and "..", as far as the path exists.
static fs::path real_path(const fs::path& path, std::error_code& error)
{
    const fs::path absolute = fs::absolute(path, error); // or the result is relative where nothing exists
    return error ? path : fs::weakly_canonical(absolute, error);
}

References::References(const fs::path& scene_file, bool sandbox, Scene& scene)
    : folder_(scene_file.parent_path()), sandbox_(sandbox), scene_(scene)
{
    std::error_code error;
    root_ = real_path(folder_.empty() ? fs::path(".") : folder_, error);
    if (error) throw Error({scene_file.string()}, fmt::format("cannot be followed: {}", error.message()));
}

static bool is_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

// "http" of "http://host/file"; empty if there is none. One letter is a drive.
static std::string scheme_of(const std::string& reference)
{
    const std::size_t end = reference.find("://");
    if (end == std::string::npos || end < 2 || !is_letter(reference[0])) return {};
    const auto legal = [](unsigned char c) { return std::isalnum(c) != 0 || c == '+' || c == '-' || c == '.'; };
    const auto from = reference.begin();
    return std::all_of(from, from + static_cast<std::ptrdiff_t>(end), legal) ? reference.substr(0, end) : std::string();
}

static bool is_there(const fs::path& file)
{
    std::error_code error;
    return fs::exists(file, error);
}

// "C:/textures/wood.png"
static bool has_drive(const std::string& reference)
{
    return reference.size() > 2 && is_letter(reference[0]) && reference[1] == ':' &&
           (reference[2] == '/' || reference[2] == '\\');
}

// Whether `file` lies in the folder `root` or below. Both canonical.
static bool is_inside(const fs::path& root, const fs::path& file)
{
    const auto [end, unused] = std::mismatch(root.begin(), root.end(), file.begin(), file.end());
    return end == root.end();
}

fs::path References::resolve(const std::string& reference, const std::string& place, const fs::path& folder)
{
    if (reference.find('\0') != std::string::npos)
        throw Error(place + "a reference to a file has a zero byte in it", "remove it");
    if (const std::string scheme = scheme_of(reference); !scheme.empty())
        throw Error(fmt::format("{}'{}' would have to be fetched ({}), and nothing is", place, reference, scheme),
                    "put the file beside the scene and refer to it by name");

    const fs::path base = folder.empty() ? folder_ : folder;
    fs::path file = base / reference;
    std::string slashed = reference;
    std::replace(slashed.begin(), slashed.end(), '\\', '/');
    if (slashed != reference && !is_there(file)) file = base / slashed;

    const bool absolute = fs::path(slashed).is_absolute() || has_drive(slashed);
    std::error_code error;
    const fs::path target = real_path(file, error);
    if (error && sandbox_)
        throw Error(fmt::format("{}'{}' cannot be followed: {}", place, reference, error.message()),
                    "correct the reference");
    const bool outside = !error && !is_inside(root_, target);
    if (!absolute && !outside) return file;

    const std::string what = absolute ? "is an absolute path" : "leads out of the scene's folder";
    if (sandbox_)
        throw Error(fmt::format("{}'{}' {}, and the sandbox ends there", place, reference, what),
                    "move the file into the scene's folder, or leave out --sandbox");
    // Paths on their author's machine are common; what they mean often lies beside the scene.
    if (const fs::path name = fs::path(slashed).filename();
        absolute && !name.empty() && !is_there(file) && is_there(base / name)) {
        if (noted_.insert(reference).second)
            note(scene_, Note::Kind::warning,
                 fmt::format("{}'{}' is an absolute path to what is not there; '{}' beside the scene is used", place,
                             reference, name.string()));
        return base / name;
    }
    if (noted_.insert(reference).second)
        note(scene_, Note::Kind::info, fmt::format("{}'{}' {}; it is followed", place, reference, what));
    return file;
}

} // namespace snell
