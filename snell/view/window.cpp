#include "snell/view/window.h"

#include "snell/core/error.h"
#include "snell/io/image/write.h"

#include <SDL.h>
#include <SDL_opengl.h>
#include <backends/imgui_impl_opengl3.h>
#include <backends/imgui_impl_sdl.h>
#include <imgui.h>

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace snell::view {

// ---- looks ----

std::filesystem::path find_font()
{
    const char* list = std::getenv("XDG_DATA_DIRS");
    std::string folders = list != nullptr && *list != '\0' ? list : "/usr/local/share:/usr/share";
    folders += ':';
    for (std::size_t begin = 0, end = 0; (end = folders.find(':', begin)) != std::string::npos; begin = end + 1) {
        const std::filesystem::path font =
            std::filesystem::path(folders.substr(begin, end - begin)) / "fonts/truetype/dejavu/DejaVuSans.ttf";
        std::error_code ignored;
        if (std::filesystem::is_regular_file(font, ignored)) return font;
    }
    return {};
}

static void load_font(float scale)
{
    ImGuiIO& io = ImGui::GetIO();
    const std::filesystem::path font = find_font();
    // Latin and Greek, arrows, mathematical and geometric signs: what scenes' names and our labels need.
    static const ImWchar ranges[] = {0x20,   0x24f,  0x370,  0x3ff,  0x2010, 0x205e, 0x2190,
                                     0x21ff, 0x2200, 0x22ff, 0x25a0, 0x25ff, 0};
    const float size = std::round(14.0f * scale);
    if (!font.empty() && io.Fonts->AddFontFromFileTTF(font.c_str(), size, nullptr, ranges) != nullptr) return;
    ImFontConfig config;
    config.SizePixels = std::round(13.0f * scale);
    io.Fonts->AddFontDefault(&config);
}

void Window::apply_style()
{
    ImGuiStyle style;
    if (is_light_)
        ImGui::StyleColorsLight(&style);
    else
        ImGui::StyleColorsDark(&style);
    style.WindowRounding = 4.0f;
    style.FrameRounding = 3.0f;
    style.GrabRounding = 3.0f;
    style.PopupRounding = 3.0f;
    style.ScrollbarSize = 12.0f;
    style.WindowBorderSize = 1.0f;
    style.FrameBorderSize = is_light_ ? 1.0f : 0.0f;
    style.ItemSpacing = ImVec2(8.0f, 5.0f);
    style.FramePadding = ImVec2(6.0f, 3.0f);
    ImVec4* colors = style.Colors;
    if (is_light_) {
        colors[ImGuiCol_WindowBg] = ImVec4(0.95f, 0.95f, 0.95f, 1.0f);
        colors[ImGuiCol_Border] = ImVec4(0.0f, 0.0f, 0.0f, 0.18f);
        colors[ImGuiCol_TextDisabled] = ImVec4(0.42f, 0.42f, 0.42f, 1.0f);
    } else {
        colors[ImGuiCol_WindowBg] = ImVec4(0.11f, 0.115f, 0.125f, 1.0f);
        colors[ImGuiCol_PopupBg] = ImVec4(0.13f, 0.135f, 0.145f, 0.98f);
        colors[ImGuiCol_MenuBarBg] = ImVec4(0.15f, 0.155f, 0.165f, 1.0f);
        colors[ImGuiCol_FrameBg] = ImVec4(0.20f, 0.21f, 0.23f, 1.0f);
        colors[ImGuiCol_FrameBgHovered] = ImVec4(0.26f, 0.28f, 0.32f, 1.0f);
        colors[ImGuiCol_FrameBgActive] = ImVec4(0.27f, 0.34f, 0.44f, 1.0f);
        colors[ImGuiCol_TextDisabled] = ImVec4(0.62f, 0.62f, 0.64f, 1.0f);
    }
    style.ScaleAllSizes(ui_scale_);
    ImGui::GetStyle() = style;
}

// ---- the window ----

static Error no_window(const std::string& why)
{
    return Error("cannot open a window: " + why,
                 "a graphical session is needed; `snell render SCENE -o picture.png` needs none");
}

static float scale_of_display()
{
    float dpi = 0.0f;
    if (SDL_GetDisplayDPI(0, nullptr, nullptr, &dpi) != 0 || !(dpi > 0.0f)) return 1.0f;
    // Many displays misreport their size a little: only what is clearly finer gets larger letters, by quarters.
    const float scale = std::round(dpi / 96.0f * 4.0f) / 4.0f;
    return scale < 1.4f ? 1.0f : std::min(scale, 3.0f);
}

Window::Window(const WindowOptions& options) : is_light_(options.is_light)
{
    const char* display = std::getenv("DISPLAY");
    const char* wayland = std::getenv("WAYLAND_DISPLAY");
    const char* driver = std::getenv("SDL_VIDEODRIVER");
    const auto is_set = [](const char* text) { return text != nullptr && *text != '\0'; };
    if (!is_set(display) && !is_set(wayland) && !is_set(driver)) throw no_window("there is no display");
    SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1"); // Ctrl-C ends the program as any other
    SDL_SetHint(SDL_HINT_MOUSE_FOCUS_CLICKTHROUGH, "1");
    SDL_SetHint(SDL_HINT_VIDEO_X11_NET_WM_BYPASS_COMPOSITOR, "0");
    if (SDL_Init(SDL_INIT_VIDEO) != 0) throw no_window(SDL_GetError());

    SDL_GL_SetAttribute(SDL_GL_CONTEXT_PROFILE_MASK, SDL_GL_CONTEXT_PROFILE_CORE);
    SDL_GL_SetAttribute(SDL_GL_CONTEXT_MAJOR_VERSION, 3);
    SDL_GL_SetAttribute(SDL_GL_CONTEXT_MINOR_VERSION, 0);
    SDL_GL_SetAttribute(SDL_GL_DOUBLEBUFFER, 1);
    SDL_GL_SetAttribute(SDL_GL_DEPTH_SIZE, 0);
    SDL_GL_SetAttribute(SDL_GL_STENCIL_SIZE, 0);
    window_ = SDL_CreateWindow(options.title.c_str(), SDL_WINDOWPOS_CENTERED, SDL_WINDOWPOS_CENTERED, options.width,
                               options.height, SDL_WINDOW_OPENGL | SDL_WINDOW_RESIZABLE | SDL_WINDOW_ALLOW_HIGHDPI);
    if (window_ != nullptr) context_ = SDL_GL_CreateContext(window_);
    if (context_ == nullptr) {
        const std::string why = SDL_GetError();
        if (window_ != nullptr) SDL_DestroyWindow(window_);
        SDL_Quit();
        throw no_window(why);
    }
    SDL_SetWindowMinimumSize(window_, 320, 240);
    SDL_GL_MakeCurrent(window_, context_);
    if (SDL_GL_SetSwapInterval(-1) != 0) SDL_GL_SetSwapInterval(1); // late frames do not wait for the next refresh

    ui_scale_ = options.ui_scale > 0.0f ? options.ui_scale : scale_of_display();
    IMGUI_CHECKVERSION();
    ImGui::CreateContext();
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr; // nothing is written into the current folder
    io.ConfigFlags |= ImGuiConfigFlags_NavEnableKeyboard | ImGuiConfigFlags_NavNoCaptureKeyboard;
    io.ConfigWindowsMoveFromTitleBarOnly = true;
    load_font(ui_scale_);
    apply_style();
    ImGui_ImplSDL2_InitForOpenGL(window_, context_);
    ImGui_ImplOpenGL3_Init("#version 130");
    SDL_EventState(SDL_DROPFILE, SDL_ENABLE);
    SDL_StartTextInput();
}

Window::~Window()
{
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplSDL2_Shutdown();
    ImGui::DestroyContext();
    SDL_GL_DeleteContext(context_);
    SDL_DestroyWindow(window_);
    SDL_Quit();
}

float Window::pixels_per_unit() const
{
    int units = 0, pixels = 0;
    SDL_GetWindowSize(window_, &units, nullptr);
    SDL_GL_GetDrawableSize(window_, &pixels, nullptr);
    return units > 0 && pixels > 0 ? static_cast<float>(pixels) / static_cast<float>(units) : 1.0f;
}

void Window::set_title(const std::string& title)
{
    SDL_SetWindowTitle(window_, title.c_str());
}

void Window::set_size(int width, int height)
{
    SDL_SetWindowSize(window_, width, height);
}

void Window::set_light(bool is_light)
{
    if (is_light == is_light_) return;
    is_light_ = is_light;
    apply_style();
}

void Window::hide()
{
    SDL_HideWindow(window_);
}

void Window::begin_frame(const Pointer& pointer)
{
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplSDL2_NewFrame();
    ImGuiIO& io = ImGui::GetIO();
    io.MousePos = pointer.is_inside ? ImVec2(pointer.x, pointer.y) : ImVec2(-FLT_MAX, -FLT_MAX);
    for (int button = 0; button < 3; ++button)
        io.MouseDown[button] = pointer.is_down[button] || pointer.was_down[button];
    ImGui::NewFrame();
}

void Window::end_frame()
{
    ImGui::Render();
    int width = 0, height = 0;
    SDL_GL_GetDrawableSize(window_, &width, &height);
    glViewport(0, 0, width, height);
    const float ground = is_light_ ? 0.75f : 0.05f;
    glClearColor(ground, ground, ground, 1.0f);
    glClear(GL_COLOR_BUFFER_BIT);
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
    if (!looks_.empty()) {
        const ScreenPicture screen = read_back();
        for (const auto& look : std::exchange(looks_, {})) look(screen);
    }
    SDL_GL_SwapWindow(window_);
}

void Window::shoot(std::filesystem::path file)
{
    inspect([file = std::move(file)](const ScreenPicture& screen) {
        Picture picture;
        picture.width = screen.width, picture.height = screen.height;
        picture.pixels.reserve(screen.texels.size());
        for (const std::uint32_t texel : screen.texels) {
            const auto channel = [&](int shift) {
                return srgb_decode(static_cast<float>(texel >> shift & 255u) / 255.0f);
            };
            picture.pixels.emplace_back(channel(0), channel(8), channel(16));
        }
        write_picture(file, picture);
    });
}

ScreenPicture Window::read_back() const
{
    ScreenPicture picture;
    SDL_GL_GetDrawableSize(window_, &picture.width, &picture.height);
    const auto width = static_cast<std::size_t>(picture.width), height = static_cast<std::size_t>(picture.height);
    picture.texels.resize(width * height);
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    glReadPixels(0, 0, picture.width, picture.height, GL_RGBA, GL_UNSIGNED_BYTE, picture.texels.data());
    for (std::size_t y = 0; y < height / 2; ++y) // OpenGL's first row is the lowest
        std::swap_ranges(picture.texels.begin() + static_cast<std::ptrdiff_t>(y * width),
                         picture.texels.begin() + static_cast<std::ptrdiff_t>((y + 1) * width),
                         picture.texels.begin() + static_cast<std::ptrdiff_t>((height - 1 - y) * width));
    return picture;
}

// ---- textures ----

Texture::~Texture()
{
    if (name_ != 0) glDeleteTextures(1, &name_);
}

void Texture::upload(const ScreenPicture& picture)
{
    const bool is_new = name_ == 0;
    if (is_new) glGenTextures(1, &name_);
    glBindTexture(GL_TEXTURE_2D, name_);
    if (is_new) {
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, is_smooth_ ? GL_LINEAR : GL_NEAREST);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    }
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    if (picture.width != width_ || picture.height != height_) {
        glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, picture.width, picture.height, 0, GL_RGBA, GL_UNSIGNED_BYTE,
                     picture.texels.data());
        width_ = picture.width, height_ = picture.height;
    } else {
        glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, picture.texels.data());
    }
}

void Texture::set_smooth(bool smooth)
{
    if (smooth == is_smooth_) return;
    is_smooth_ = smooth;
    if (name_ == 0) return;
    glBindTexture(GL_TEXTURE_2D, name_);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, smooth ? GL_LINEAR : GL_NEAREST);
}

void* Texture::id() const
{
    return reinterpret_cast<void*>(static_cast<std::uintptr_t>(name_)); // as ImGui's OpenGL backend wants it
}

} // namespace snell::view
