// What reading a pbrt file has to say, each thing once.
#pragma once

#include "snell/io/pbrt/tokenizer.h"
#include "snell/scene/scene.h"

#include <set>
#include <string>

namespace snell::pbrt {

class Notes
{
  public:
    explicit Notes(Scene& scene) : scene_(scene) {}

    // A note with its place, unless there was one with this key before. After `most` of them only their number counts.
    void warn(const Spot& spot, const std::string& key, const std::string& text)
    {
        add(Note::Kind::warning, spot, key, text);
    }
    void inform(const Spot& spot, const std::string& key, const std::string& text)
    {
        add(Note::Kind::info, spot, key, text);
    }

    static constexpr std::size_t most = 500;

  private:
    void add(Note::Kind kind, const Spot& spot, const std::string& key, const std::string& text)
    {
        if (said_.size() > most || !said_.insert(key).second) return;
        if (said_.size() > most)
            note(scene_, Note::Kind::warning,
                 fmt::format("{}there is more to say about this file; after {} notes only this one follows",
                             spot.prefix(), most));
        else
            note(scene_, kind, spot.prefix() + text);
    }

    Scene& scene_;
    std::set<std::string> said_;
};

} // namespace snell::pbrt
