// The window: SDL2, an OpenGL context, and Dear ImGui in them.
#pragma once

#include "snell/view/display.h"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

struct SDL_Window;
union SDL_Event;

namespace snell::view {

struct WindowOptions
{
    std::string title = "snell";
    int width = 1280, height = 720;
    float ui_scale = 0.0f; // of letters and controls; 0: by the display's resolution
    bool is_light = false;
};

// Where the mouse is, by the events that came; in ImGui's units.
struct Pointer
{
    float x = -1, y = -1;
    bool is_inside = false;
    bool is_down[3] = {false, false, false};  // left, right, middle
    bool was_down[3] = {false, false, false}; // pressed since the last frame, though perhaps released by now
};

class Window
{
  public:
    // Throws Error, with what to do instead, if there is no display or no OpenGL.
    explicit Window(const WindowOptions& options);
    ~Window();
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    SDL_Window* handle() const { return window_; }
    float ui_scale() const { return ui_scale_; }
    // Pixels for a unit of ImGui's; above 1 where the system itself scales.
    float pixels_per_unit() const;
    void set_title(const std::string& title);
    void set_size(int width, int height);
    void set_light(bool is_light);
    void hide(); // at once, while the rest of the program comes to its end

    // ImGui gets the pointer from here and not from SDL's own state, so that events that a script has made count as
    // real ones do.
    void begin_frame(const Pointer& pointer);
    // Draws what ImGui has, and shows it.
    void end_frame();
    // The next end_frame() writes what it has drawn there, as PNG.
    void shoot(std::filesystem::path file);
    // The next end_frame() shows it what was drawn.
    void inspect(std::function<void(const ScreenPicture&)> look) { looks_.push_back(std::move(look)); }

  private:
    void apply_style();
    ScreenPicture read_back() const;

    SDL_Window* window_ = nullptr;
    void* context_ = nullptr;
    float ui_scale_ = 1.0f;
    bool is_light_ = false;
    std::vector<std::function<void(const ScreenPicture&)>> looks_;
};

// A picture on the GPU.
class Texture
{
  public:
    Texture() = default;
    ~Texture();
    Texture(const Texture&) = delete;
    Texture& operator=(const Texture&) = delete;

    void upload(const ScreenPicture& picture);
    void set_smooth(bool smooth); // bilinear, or the nearest texel
    void* id() const;             // ImTextureID
    bool empty() const { return name_ == 0; }
    int width() const { return width_; }
    int height() const { return height_; }

  private:
    unsigned name_ = 0;
    int width_ = 0, height_ = 0;
    bool is_smooth_ = true;
};

// For a user interface's letters: the file, or empty if the machine has none that we know.
std::filesystem::path find_font();

} // namespace snell::view
