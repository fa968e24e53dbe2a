// What the readers and validate() noted, sorted into kinds by their words.
#include "snell/scene/doctor_parts.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace snell::doctor {

using Severity = Finding::Severity;

namespace {
struct Rule
{
    std::string_view word, and_word; // both must occur
    std::string_view kind;
    Severity warning; // the severity of a note that is a warning; the others are infos
};
} // namespace

// The first that fits counts.
static constexpr std::array rules = {
    Rule{"dropped", "without area", "degenerate-triangles", Severity::repaired},
    Rule{"dropped", "NaN, infinite", "non-finite-vertices", Severity::repaired},
    Rule{"dropped", "spheres without", "degenerate-spheres", Severity::repaired},
    Rule{"non-finite normal", "", "zero-normals", Severity::repaired},
    Rule{"non-finite tangent", "", "zero-tangents", Severity::repaired},
    Rule{"non-finite texture coordinate", "", "non-finite-uvs", Severity::repaired},
    Rule{"vertex colour", "outside [0, 1]", "unphysical-vertex-colours", Severity::repaired},
    Rule{"not physical, mended", "", "unphysical-material", Severity::repaired},
    Rule{"values outside [0, 1]", "", "unphysical-texture", Severity::repaired},
    Rule{"light ", "mended:", "unphysical-light", Severity::repaired},
    Rule{"environment", "replaced", "unphysical-environment", Severity::repaired},
    Rule{"no material: a grey", "", "no-material", Severity::repaired},
    Rule{"up direction", "replaced", "camera-up", Severity::repaired},
    Rule{"concave", "", "concave-polygons", Severity::repaired},
    Rule{"polygon", "", "odd-polygons", Severity::repaired},
    Rule{"after the last facet", "", "trailing-bytes", Severity::repaired},
    Rule{"more in the file than its header", "", "trailing-bytes", Severity::repaired},
    Rule{"magenta", "", "missing-texture", Severity::doubtful},
    Rule{"material library", "", "missing-material", Severity::doubtful},
    Rule{"no library has the material", "", "missing-material", Severity::doubtful},
    Rule{"no such file", "", "missing-file", Severity::doubtful},
    Rule{"is not there", "", "missing-file", Severity::doubtful},
    Rule{"it is followed", "", "outside-reference", Severity::doubtful},
    Rule{"extension", "", "ignored-extension", Severity::doubtful},
    Rule{"ignored", "", "ignored", Severity::doubtful},
    Rule{"left out", "", "left-out", Severity::doubtful},
    Rule{"not used", "", "ignored", Severity::doubtful},
    Rule{"stands in", "", "approximated", Severity::doubtful},
    Rule{"becomes", "", "approximated", Severity::doubtful},
    Rule{"is taken", "", "approximated", Severity::doubtful},
};

// The first number in the text that is a count: of "mesh 'a': dropped 12 triangles" the 12.
static std::size_t count_in(std::string_view text, std::string_view word)
{
    const std::size_t at = text.find(word);
    if (at == std::string_view::npos) return 1;
    std::size_t i = at + word.size();
    std::size_t count = 0;
    for (std::size_t digits = 0; i < text.size() && std::isdigit(static_cast<unsigned char>(text[i])) && digits < 12;
         ++i, ++digits)
        count = 10 * count + static_cast<std::size_t>(text[i] - '0');
    return std::max<std::size_t>(count, 1);
}

void take_notes(const Scene& scene, Findings& findings)
{
    for (const Note& note : scene.notes) {
        const auto fits = [&](const Rule& rule) {
            return note.text.find(rule.word) != std::string::npos && note.text.find(rule.and_word) != std::string::npos;
        };
        const auto rule = std::find_if(rules.begin(), rules.end(), fits);
        const bool is_warning = note.kind == Note::Kind::warning;
        const std::size_t count = std::max(
            {count_in(note.text, "dropped "), count_in(note.text, "replaced "), count_in(note.text, "mended ")});
        if (rule == rules.end())
            findings.add(is_warning ? "warning" : "note", is_warning ? Severity::doubtful : Severity::info, note.text,
                         count);
        else
            findings.add(rule->kind, is_warning ? rule->warning : Severity::info, note.text, count);
    }
}

} // namespace snell::doctor
