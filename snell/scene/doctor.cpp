#include "snell/scene/doctor.h"

#include "snell/core/error.h"
#include "snell/scene/doctor_parts.h"
#include "snell/scene/validate_mesh.h"

#include <algorithm>
#include <optional>

namespace snell {

std::string_view to_string(Finding::Severity severity)
{
    switch (severity) {
    case Finding::Severity::info:
        return "info";
    case Finding::Severity::repaired:
        return "repaired";
    case Finding::Severity::doubtful:
        return "doubtful";
    case Finding::Severity::error:
        return "error";
    }
    fail_check(__FILE__, __LINE__, "unknown severity");
}

namespace doctor {

void Findings::add(std::string_view kind, Finding::Severity severity, std::string text, std::size_t count)
{
    auto found = kinds_.find(kind);
    if (found == kinds_.end()) found = kinds_.emplace(std::string(kind), Kind{}).first;
    Kind& of_kind = found->second;
    ++of_kind.found[static_cast<int>(severity)];
    if (of_kind.listed.size() < SceneReport::listed_of_a_kind)
        of_kind.listed.push_back({std::string(kind), severity, std::move(text), count});
    else {
        ++of_kind.unlisted;
        of_kind.unlisted_count += count;
    }
}

void Findings::close(SceneReport& report)
{
    for (auto& [name, kind] : kinds_) {
        report.infos += kind.found[0];
        report.repaired += kind.found[1];
        report.doubtful += kind.found[2];
        report.errors += kind.found[3];
        Finding::Severity gravest = Finding::Severity::info;
        for (Finding& finding : kind.listed) {
            gravest = std::max(gravest, finding.severity);
            report.findings.push_back(std::move(finding));
        }
        if (kind.unlisted > 0)
            report.findings.push_back({name, gravest, fmt::format("and {} more of this kind ({})", kind.unlisted, name),
                                       kind.unlisted_count});
    }
    std::stable_sort(report.findings.begin(), report.findings.end(),
                     [](const Finding& a, const Finding& b) { return a.severity > b.severity; });
    kinds_.clear();
}

std::string amount(std::size_t count, std::string_view one)
{
    std::string digits = std::to_string(count);
    for (std::size_t i = digits.size(); i > 3; i -= 3) digits.insert(i - 3, ",");
    std::string word(one);
    if (count != 1) word += "s";
    return digits + " " + word;
}

std::string mesh_label(const Scene& scene, uint mesh)
{
    return fmt::format("mesh {}", label(scene.meshes[mesh].name, mesh));
}

} // namespace doctor

SceneReport examine(const Scene& scene)
{
    SceneReport report;
    doctor::Findings findings;
    doctor::take_notes(scene, findings);
    const std::vector<doctor::MeshFacts> facts = doctor::find_mesh_facts(scene);

    std::optional<PackedScene> packed;
    try {
        packed = pack(scene);
    } catch (const Error& error) {
        findings.add("cannot-render", Finding::Severity::error, error.what());
    }
    doctor::count(scene, packed ? &*packed : nullptr, report);
    packed.reset();

    doctor::check_placement(scene, facts, report, findings);
    doctor::check_shapes(scene, facts, findings);
    doctor::check_double_faces(scene, findings);
    doctor::check_solids(scene, facts, findings);
    doctor::check_lamps(scene, facts, findings);
    doctor::check_extents(scene, facts, report.bounds, findings);
    doctor::check_materials(scene, facts, findings);
    findings.close(report);
    return report;
}

} // namespace snell
