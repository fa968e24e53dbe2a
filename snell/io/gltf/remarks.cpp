#include "snell/io/gltf/remarks.h"

namespace snell::gltf {

void Remarks::add(Remark remark)
{
    // A handful of kinds: no need for a map.
    for (Remark& known : all_) {
        if (known.kind != remark.kind) continue;
        known.count += remark.count;
        return;
    }
    all_.push_back(std::move(remark));
}

void Remarks::append(const Remarks& others)
{
    for (const Remark& remark : others.all_) add(remark);
}

void Remarks::tell(Scene& scene, const std::string& file) const
{
    for (const Remark& remark : all_) {
        std::string text = fmt::format("{}: {}", file, remark.text);
        if (remark.count > 1) text += fmt::format(" (and {} more of this kind)", remark.count - 1);
        note(scene, remark.level, std::move(text));
    }
}

} // namespace snell::gltf
