#include "snell/io/calibration.h"

#include "snell/core/error.h"
#include "snell/io/file.h"
#include "snell/scene/camera_models.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <string>
#include <vector>

namespace snell {
namespace {

constexpr std::uintmax_t largest_file = 1 << 20; // a calibration has a few hundred bytes, with its points some 100,000

// The three notations have this in common: a name, and numbers behind it; those of a matrix behind the word "data".
class Storage
{
  public:
    explicit Storage(const std::filesystem::path& file) : file_(file)
    {
        std::error_code code;
        if (std::filesystem::file_size(file, code) > largest_file && !code)
            throw Error({file.string(), 0, 0}, "this is larger than any calibration",
                        "give a file that OpenCV's calibration has written");
        text_ = read_file(file);
    }

    [[noreturn]] void fail(std::size_t at, const std::string& message, const std::string& remedy) const
    {
        const auto line = std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(at), '\n') + 1;
        throw Error({file_.string(), static_cast<int>(line), 0}, message, remedy);
    }

    // Behind the first of the names that is there as a key.
    std::optional<std::size_t> find(std::initializer_list<std::string_view> names) const
    {
        for (const std::string_view name : names)
            for (std::size_t at = text_.find(name); at != std::string::npos; at = text_.find(name, at + 1))
                if (is_key(at, name.size())) return at + name.size();
        return {};
    }

    std::size_t find_or_fail(std::initializer_list<std::string_view> names) const
    {
        if (const auto at = find(names)) return *at;
        throw Error({file_.string(), 0, 0}, fmt::format("there is no {} in this calibration", *names.begin()),
                    "give a file that OpenCV's calibration has written");
    }

    // The number behind a key.
    float number(std::size_t at) const
    {
        const std::vector<float> one = numbers(skip(at, ":>\" \t"), 1);
        if (one.empty()) fail(at, "here a number is missing", "write one behind the name");
        return one.front();
    }

    // The numbers of the matrix behind a key.
    std::vector<float> matrix(std::size_t at) const
    {
        const std::size_t data = text_.find("data", at);
        if (data == std::string::npos) fail(at, "this matrix has no data", "write data: [ ... ] below it");
        return numbers(skip(data + 4, ":>[\" \t\r\n"), 100);
    }

    std::string word(std::size_t at) const
    {
        std::size_t begin = skip(at, ":>\" \t"), end = begin;
        while (end < text_.size() && (std::isalnum(static_cast<unsigned char>(text_[end])) || text_[end] == '_')) ++end;
        return text_.substr(begin, end - begin);
    }

  private:
    bool is_key(std::size_t at, std::size_t size) const
    {
        const auto is_name = [&](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; };
        if (at > 0 && (is_name(text_[at - 1]) || text_[at - 1] == '/')) return false;
        const std::size_t end = at + size;
        if (end >= text_.size() || is_name(text_[end])) return false;
        const bool is_tag = at > 0 && text_[at - 1] == '<';
        const std::size_t colon = skip(end, "\" \t");
        return is_tag || (colon < text_.size() && text_[colon] == ':');
    }

    std::size_t skip(std::size_t at, std::string_view what) const
    {
        const std::size_t next = text_.find_first_not_of(what, at);
        return next == std::string::npos ? text_.size() : next;
    }

    std::vector<float> numbers(std::size_t at, std::size_t most) const
    {
        std::vector<float> all;
        while (all.size() < most) {
            at = skip(at, ", \t\r\n");
            if (at >= text_.size() || text_[at] == ']' || text_[at] == '<' || text_[at] == '"') break;
            float value = 0;
            const char* first = text_.data() + at + (text_[at] == '+' ? 1 : 0);
            const auto [end, code] = std::from_chars(first, text_.data() + text_.size(), value);
            if (code != std::errc() || !std::isfinite(value)) {
                if (most == 1) break;
                fail(at, "here a number is expected", "mend it, or calibrate again");
            }
            all.push_back(value);
            at = static_cast<std::size_t>(end - text_.data());
        }
        return all;
    }

    std::filesystem::path file_;
    std::string text_;
};

} // namespace

CameraModel load_calibration(const std::filesystem::path& file, std::optional<uint> kind)
{
    const Storage storage(file);
    CameraModel model;
    const auto size = [&](std::initializer_list<std::string_view> names) {
        const std::size_t at = storage.find_or_fail(names);
        const float pixels = storage.number(at);
        if (!(pixels > 0.0f)) storage.fail(at, "a picture without pixels", "write a number above 0");
        return pixels;
    };
    model.calibrated_width = size({"image_width", "imageWidth"});
    model.calibrated_height = size({"image_height", "imageHeight"});

    const std::size_t at = storage.find_or_fail({"camera_matrix", "cameraMatrix", "K"});
    const std::vector<float> k = storage.matrix(at);
    if (k.size() != 9)
        storage.fail(at, fmt::format("the camera matrix has {} numbers", k.size()), "it must have 3 times 3");
    if (k[1] != 0.0f) storage.fail(at, "the camera matrix has a skew", "calibrate without it");
    model.focal = vec2(k[0], k[4]);
    model.center = vec2(k[2] + 0.5f, k[5] + 0.5f); // OpenCV's (0, 0) is the middle of the first pixel

    const auto fisheye = storage.find({"fisheye_model"});
    const auto name = storage.find({"distortion_model"});
    const std::string said = name ? storage.word(*name) : "";
    const bool is_fisheye = (fisheye && storage.number(*fisheye) != 0.0f) || said == "equidistant" ||
                            said == "fisheye" || said.starts_with("kannala");
    model.kind = kind.value_or(is_fisheye ? camera_kannala_brandt : camera_brown_conrady);

    const std::size_t d = storage.find_or_fail({"distortion_coefficients", "distCoeffs", "D"});
    std::vector<float> coefficients = storage.matrix(d);
    // 12 and 14: thin prism and tilt, which are not there; left out where they are 0.
    if (model.kind == camera_brown_conrady && coefficients.size() > 8 &&
        std::all_of(coefficients.begin() + 8, coefficients.end(), [](float c) { return c == 0.0f; }))
        coefficients.resize(8);
    if (!set_distortion(model, coefficients))
        storage.fail(d, fmt::format("{} distortion coefficients", coefficients.size()),
                     model.kind == camera_kannala_brandt
                         ? "the fisheye model has 4"
                         : "4, 5 or 8 are possible; calibrate without thin prism or tilt");
    CameraDesc probe;
    probe.model = model;
    if (const std::string fault = camera_fault(probe); !fault.empty()) storage.fail(at, fault, "");
    return model;
}

} // namespace snell
