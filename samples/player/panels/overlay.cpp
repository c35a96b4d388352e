#include "panels/overlay.h"

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>

#include <cfloat>
#include <filesystem>

namespace pliant::player {
namespace {

constexpr float text_size = 17.0f, small_size = 14.0f, title_size = 23.0f;

// Where Debian, Fedora and Arch install DejaVu Sans.
constexpr const char* font_folders[]
    = { "/usr/share/fonts/truetype/dejavu/", "/usr/share/fonts/dejavu-sans-fonts/", "/usr/share/fonts/TTF/" };

// Latin, Greek, Cyrillic, and the punctuation in the player's texts.
const ImWchar glyph_ranges[] = { 0x20, 0x24F, 0x370, 0x52F, 0x2010, 0x2027, 0x2190, 0x2193, 0x2264, 0x2265, 0 };

ImFont* load_font(const char* name, float size)
{
    ImFontAtlas* fonts = ImGui::GetIO().Fonts;
    for (const char* folder : font_folders) {
        const std::string path = std::string(folder) + name;
        std::error_code error;
        if (std::filesystem::is_regular_file(path, error))
            if (ImFont* font = fonts->AddFontFromFileTTF(path.c_str(), size, nullptr, glyph_ranges)) return font;
    }
    ImFontConfig built_in;
    built_in.SizePixels = size;
    return fonts->AddFontDefault(&built_in);
}

ImVec4 colour(int r, int g, int b, float a)
{
    return { static_cast<float>(r) / 255.0f, static_cast<float>(g) / 255.0f, static_cast<float>(b) / 255.0f, a };
}

} // namespace

Overlay::Overlay(float scale, GLFWwindow* window)
    : scale_(scale)
    , window_(window)
{
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr; // the layout places all panels: no settings to save
    if (window_) ImGui_ImplGlfw_InitForOpenGL(window_, true);
    ImGui_ImplOpenGL3_Init("#version 330 core");
    load_fonts();
    set_style();
}

Overlay::~Overlay()
{
    ImGui_ImplOpenGL3_Shutdown();
    if (window_) ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
}

void Overlay::load_fonts()
{
    text_ = load_font("DejaVuSans.ttf", text_size * scale_);
    small_ = load_font("DejaVuSans.ttf", small_size * scale_);
    title_ = load_font("DejaVuSans-Bold.ttf", title_size * scale_);
}

void Overlay::set_style()
{
    ImGui::StyleColorsLight();
    ImGuiStyle& style = ImGui::GetStyle();
    style.WindowRounding = 14.0f;
    style.WindowBorderSize = 1.0f;
    style.WindowPadding = { 18.0f, 15.0f };
    style.FrameRounding = 9.0f;
    style.FramePadding = { 10.0f, 6.0f };
    style.ItemSpacing = { 8.0f, 7.0f };
    style.AntiAliasedFill = style.AntiAliasedLines = true;
    style.Colors[ImGuiCol_Text] = ImGui::ColorConvertU32ToFloat4(ink);
    style.Colors[ImGuiCol_WindowBg] = colour(255, 255, 255, 0.66f);
    style.Colors[ImGuiCol_Border] = colour(255, 255, 255, 0.85f);
    style.Colors[ImGuiCol_Button] = colour(40, 52, 76, 0.07f);
    style.Colors[ImGuiCol_ButtonHovered] = colour(40, 52, 76, 0.14f);
    style.Colors[ImGuiCol_ButtonActive] = colour(40, 52, 76, 0.22f);
    style.ScaleAllSizes(scale_);
}

void Overlay::begin_frame(int width, int height)
{
    ImGui_ImplOpenGL3_NewFrame();
    if (window_) {
        ImGui_ImplGlfw_NewFrame();
    } else {
        ImGuiIO& io = ImGui::GetIO();
        io.DisplaySize = { static_cast<float>(width), static_cast<float>(height) };
        io.DeltaTime = 1.0f / 60.0f;
        io.MousePos = { -FLT_MAX, -FLT_MAX };
    }
    ImGui::NewFrame();
    ImGui::PushFont(text_);
}

void Overlay::end_frame()
{
    ImGui::PopFont();
    ImGui::Render();
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

void Overlay::discard_frame()
{
    ImGui::PopFont();
    ImGui::EndFrame();
}

ImVec2 draw_text(ImDrawList* list, ImFont* font, ImVec2 place, ImVec2 anchor, ImU32 colour, const std::string& text)
{
    const ImVec2 size = font->CalcTextSizeA(font->FontSize, FLT_MAX, 0.0f, text.c_str());
    list->AddText(font, font->FontSize, { place.x - anchor.x * size.x, place.y - anchor.y * size.y }, colour, text.c_str());
    return size;
}

namespace {

float width_of(ImFont* font, const std::string& text)
{
    return font->CalcTextSizeA(font->FontSize, FLT_MAX, 0.0f, text.c_str()).x;
}

bool continues_letter(char byte) { return (static_cast<unsigned char>(byte) & 0xC0) == 0x80; } // in UTF-8

void drop_last_letter(std::string& text)
{
    while (!text.empty() && continues_letter(text.back())) text.pop_back();
    if (!text.empty()) text.pop_back();
}

void drop_first_letter(std::string& text)
{
    if (!text.empty()) text.erase(0, 1);
    while (!text.empty() && continues_letter(text.front())) text.erase(0, 1);
}

} // namespace

std::string shortened(ImFont* font, const std::string& text, float room)
{
    if (width_of(font, text) <= room) return text;
    std::string start = text;
    while (!start.empty() && width_of(font, start + "…") > room) drop_last_letter(start);
    return start + "…";
}

std::string elided(ImFont* font, const std::string& text, float room)
{
    if (width_of(font, text) <= room) return text;
    std::size_t middle = text.size() / 2;
    while (middle > 0 && continues_letter(text[middle])) --middle;
    std::string start = text.substr(0, middle), end = text.substr(middle);
    while (!(start.empty() && end.empty()) && width_of(font, start + "…" + end) > room) {
        if (start.size() > end.size())
            drop_last_letter(start);
        else
            drop_first_letter(end);
    }
    return start + "…" + end;
}

std::string grouped(std::uint64_t number)
{
    std::string digits = std::to_string(number);
    for (int i = static_cast<int>(digits.size()) - 3; i > 0; i -= 3) digits.insert(static_cast<std::size_t>(i), ",");
    return digits;
}

} // namespace pliant::player
