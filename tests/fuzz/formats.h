// Every format that snell reads, as something that takes bytes: shared by the fuzzer and by tests/hostile.
#pragma once

#include "snell/core/error.h"

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace snell::hostile {

struct Format
{
    std::string name;      // "ply"
    std::string file;      // the name under which the bytes are written
    std::string main;      // the file to open; the same, or one that refers to it
    bool is_text = false;  // errors should say where
    bool is_image = false; // main is opened as a picture, else as a scene

    // What may lie beside the file: name and content.
    std::map<std::string, std::string> companions = {};
};

const std::vector<Format>& formats();

// nullptr if there is none of that name.
const Format* find_format(std::string_view name);

// A folder with the format's companions in it, gone in the end. Where: TMPDIR, or else the system's.
class Nest
{
  public:
    explicit Nest(const Format& format);
    ~Nest();
    Nest(const Nest&) = delete;
    Nest& operator=(const Nest&) = delete;

    // Puts the bytes where the format has them.
    void put(std::string_view bytes) const;
    // Opens the format's main file, and all that it refers to: what an Error says, or nothing if it could be read.
    // Reads pictures both as pictures and as textures, and makes scenes complete. Whatever else is thrown goes through.
    std::optional<Error> open() const;

    const std::filesystem::path& folder() const { return folder_; }

  private:
    const Format& format_;
    std::filesystem::path folder_;
};

} // namespace snell::hostile
