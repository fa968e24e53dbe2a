// snell compare: how much two pictures differ.
#include "commands.h"
#include "console.h"
#include "options.h"
#include "usage.h"

#include "snell/core/error.h"
#include "snell/io/image/read.h"
#include "snell/io/image/write.h"
#include "snell/lab/metrics.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <limits>

namespace snell::app {

namespace {
struct Request
{
    std::string picture, reference, reference_option, difference;
    std::vector<std::string> metrics; // in the order asked for
    std::optional<double> threshold;
    bool json = false;
};
} // namespace

static const std::vector<std::string> known_metrics = {"mse", "relmse", "psnr"};

static void add_metrics(Request& request, const std::string& list)
{
    for (std::size_t begin = 0; begin <= list.size();) {
        const std::size_t end = std::min(list.find(',', begin), list.size());
        const std::string name = list.substr(begin, end - begin);
        check_name("metric", name, known_metrics);
        request.metrics.push_back(name);
        begin = end + 1;
    }
}

static double value_of(const PictureError& error, const std::string& metric)
{
    return metric == "mse" ? error.mse : metric == "relmse" ? error.relmse : error.psnr;
}

// Written so that NaN is no success.
static bool within(const std::string& metric, double value, double threshold)
{
    return metric == "psnr" ? value >= threshold : value <= threshold;
}

int run_compare(const Arguments& arguments)
{
    Request request;
    Options options(
        "compare", "Measures how much picture A differs from the reference B, in scene-linear values.",
        "Exit code: 0 within the threshold (or none given), 1 beyond it or with values that are not finite.\n"
        "mse: mean squared error; relmse: squared error over squared reference, on luminance;\n"
        "psnr: in dB for a peak of 1, higher is better.\n\n"
        "Examples:\n"
        "  snell compare mine.exr reference.exr\n"
        "  snell compare mine.exr reference.exr --metric relmse --threshold 0.01\n"
        "  snell compare before.png after.png -o difference.png --json\n");
    options.positional("A", "The picture", [&](const std::string& text) { request.picture = text; });
    options.positional(
        "B", "The reference", [&](const std::string& text) { request.reference = text; }, false);
    options.value("--reference", "FILE", "The reference, instead of B",
                  [&](const std::string& text) { request.reference_option = text; });
    options.values("--metric,--metrics", "LIST", "Of mse, relmse, psnr, with commas between them [all]",
                   [&](const std::string& text) { add_metrics(request, text); });
    options.value("--threshold", "X", "Fail if the (first) metric, relmse by default, is beyond X",
                  [&](const std::string& text) {
                      request.threshold = parse_number("--threshold", text, std::numeric_limits<double>::lowest(),
                                                       std::numeric_limits<double>::max());
                  });
    options.value("-o,--output,--outfile", "FILE", "Write the absolute difference as a picture",
                  [&](const std::string& text) { request.difference = text; });
    options.flag("--json", "Print one JSON object", [&] { request.json = true; });
    options.flag("-q,--quiet", "Print no messages", [&] { console().level = Console::Level::quiet; });
    if (const auto code = options.parse(arguments)) return *code;

    if (request.reference.empty() == request.reference_option.empty())
        throw UsageError("give one reference: snell compare A B, or snell compare A --reference B");
    if (request.reference.empty()) request.reference = request.reference_option;
    const std::string judged = request.metrics.empty() ? "relmse" : request.metrics[0];
    if (request.metrics.empty()) request.metrics = known_metrics;
    if (request.threshold && *request.threshold < 0 && judged != "psnr")
        throw UsageError(
            fmt::format("--threshold: {:g} is out of range; {} is never below 0", *request.threshold, judged));
    if (!request.difference.empty()) check_writable(request.difference);

    const Picture picture = read_picture(request.picture), reference = read_picture(request.reference);
    const PictureError error = compare_pictures(picture, reference);
    if (!request.difference.empty()) {
        write_picture(request.difference, difference_picture(picture, reference));
        console().info(fmt::format("wrote {}", request.difference));
    }

    const bool finite = error.bad_pixels == 0 && error.bad_reference_pixels == 0;
    const bool pass = finite && (!request.threshold || within(judged, value_of(error, judged), *request.threshold));
    if (request.json) {
        nlohmann::ordered_json json;
        json["picture"] = request.picture;
        json["reference"] = request.reference;
        json["width"] = picture.width;
        json["height"] = picture.height;
        for (const std::string& metric : request.metrics) { // JSON has no infinity: null
            const double value = value_of(error, metric);
            json[metric] = std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json();
        }
        json["non_finite_pixels"] = error.bad_pixels;
        json["non_finite_reference_pixels"] = error.bad_reference_pixels;
        if (request.threshold) {
            json["metric"] = judged;
            json["threshold"] = *request.threshold;
        }
        json["pass"] = pass;
        fmt::print("{}\n", json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
    } else {
        for (const std::string& metric : request.metrics)
            fmt::print("{:7} {:.6g}{}\n", metric, value_of(error, metric), metric == "psnr" ? " dB" : "");
    }
    if (error.bad_pixels)
        console().warning(fmt::format("{}: {} pixels are not finite", request.picture, error.bad_pixels));
    if (error.bad_reference_pixels)
        console().warning(fmt::format("{}: {} pixels are not finite", request.reference, error.bad_reference_pixels));
    if (finite && !pass)
        console().info(
            fmt::format("{} {:.6g} is beyond the threshold {:g}", judged, value_of(error, judged), *request.threshold));
    return pass ? 0 : 1;
}

} // namespace snell::app
