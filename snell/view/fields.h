// Controls for the numbers of a scene's parts, which remember whether something has changed.
#pragma once

#include "snell/scene/scene.h"

#include <cstdint>
#include <span>

namespace snell::view {

// Draws controls for the parts of one value. Afterwards: has anything changed, and by which control (for
// History::apply()). help: what it does, with the textbook's term.
class Fields
{
  public:
    bool changed() const { return changed_; }
    std::uint64_t control() const { return control_; }

    void part(const char* label, float& value, const char* help); // in [0, 1]
    void slide(const char* label, float& value, float least, float most, const char* help);
    void drag(const char* label, float& value, float step, float least, float most, const char* help);
    void vector(const char* label, vec3& value, float step, const char* help);
    void color(const char* label, vec3& value, const char* help); // each in [0, 1]
    // What may be brighter than 1: a colour and how strong it is.
    void light(const char* label, vec3& value, const char* help);
    void flag(const char* label, bool& value, const char* help);
    void choice(const char* label, uint& value, std::span<const char* const> names, const char* help);
    void image(const char* label, Index<Image>& value, const Scene& scene, const char* help);
    // One of the scene's pictures, or none, and how it is looked up.
    void texture(const char* label, TextureRef& value, const Scene& scene, const char* help);
    void material(const char* label, Index<MaterialDesc>& value, const Scene& scene, const char* help);
    // Another control has changed it.
    void touch(const char* label);

  private:
    bool changed_ = false;
    std::uint64_t control_ = 0;
};

// Names as lists show them: the name, or the number in brackets where there is none.
std::string shown_name(const std::string& name, std::size_t number);

} // namespace snell::view
