#include "panels/overlay.h"

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>

#include <algorithm>
#include <cfloat>
#include <filesystem>

// Written by fonts/embed.cmake.
extern const unsigned char dejavu_sans[], dejavu_sans_bold[];
extern const unsigned dejavu_sans_size, dejavu_sans_bold_size;

namespace pliant::player {
namespace {

constexpr float text_size = 17.0f, small_size = 14.0f, title_size = 23.0f;
constexpr float smallest_size = 11.0f; // pixels of the framebuffer

// The letters of the player's own fonts (fonts/): Latin, Greek, Cyrillic, and the punctuation in the player's texts. The
// bold one has Latin letters only.
const ImWchar own_ranges[] = { 0x20, 0x24F, 0x370, 0x52F, 0x2010, 0x2027, 0x2190, 0x2193, 0x2264, 0x2265, 0 };

// Where systems install fonts with Chinese, Japanese and Korean letters; the first ones are preferred.
constexpr const char* other_fonts[] = { "/usr/share/fonts/opentype/noto/NotoSansCJK-Regular.ttc",
                                        "/usr/share/fonts/noto-cjk/NotoSansCJK-Regular.ttc",
                                        "/usr/share/fonts/google-noto-sans-cjk-fonts/NotoSansCJK-Regular.ttc",
                                        "/usr/share/fonts/opentype/ipafont-gothic/ipag.ttf",
                                        "/usr/share/fonts/truetype/wqy/wqy-microhei.ttc",
                                        "/usr/share/fonts/wenquanyi/wqy-microhei/wqy-microhei.ttc",
                                        "/usr/share/fonts/truetype/wqy/wqy-zenhei.ttc",
                                        "/usr/share/fonts/truetype/nanum/NanumGothic.ttf",
                                        "/usr/share/fonts/truetype/droid/DroidSansFallbackFull.ttf",
                                        "/usr/share/fonts/truetype/unifont/unifont.ttf",
                                        "/System/Library/Fonts/PingFang.ttc",
                                        "C:/Windows/Fonts/msgothic.ttc",
                                        "C:/Windows/Fonts/msyh.ttc" };

void add_own_font(const unsigned char* bytes, unsigned size, float pixels, bool merge)
{
    ImFontConfig config;
    config.FontDataOwnedByAtlas = false;
    config.MergeMode = merge;
    ImGui::GetIO().Fonts->AddFontFromMemoryTTF(const_cast<unsigned char*>(bytes), static_cast<int>(size), pixels, &config,
                                               own_ranges);
}

void add_other_fonts(float pixels, const std::vector<ImWchar>& ranges)
{
    if (ranges.empty()) return;
    ImFontConfig config;
    config.MergeMode = true;
    for (const char* path : other_fonts) {
        std::error_code error;
        if (std::filesystem::is_regular_file(path, error))
            ImGui::GetIO().Fonts->AddFontFromFileTTF(path, pixels, &config, ranges.data());
    }
}

bool is_own(ImWchar letter)
{
    for (const ImWchar* range = own_ranges; *range; range += 2)
        if (letter >= range[0] && letter <= range[1]) return true;
    return false;
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
    ImFontAtlas* fonts = ImGui::GetIO().Fonts;
    fonts->Clear();
    for (const float pixels : { text_size * scale_, std::max(small_size * scale_, smallest_size), title_size * scale_ }) {
        const bool is_title = fonts->Fonts.Size == 2;
        if (is_title) add_own_font(dejavu_sans_bold, dejavu_sans_bold_size, pixels, false);
        add_own_font(dejavu_sans, dejavu_sans_size, pixels, is_title);
        add_other_fonts(pixels, other_ranges_);
    }
    text_ = fonts->Fonts[0];
    small_ = fonts->Fonts[1];
    title_ = fonts->Fonts[2];
}

void Overlay::need_letters(const std::string& text)
{
    ImFontGlyphRangesBuilder builder;
    builder.AddText(text.c_str());
    const std::size_t before = other_letters_.size();
    for (unsigned letter = 0x80; letter <= IM_UNICODE_CODEPOINT_MAX; ++letter)
        if (builder.GetBit(letter) && !is_own(static_cast<ImWchar>(letter)))
            other_letters_.insert(static_cast<ImWchar>(letter));
    if (other_letters_.size() == before) return;
    other_ranges_.clear();
    for (ImWchar letter : other_letters_) other_ranges_.insert(other_ranges_.end(), { letter, letter });
    other_ranges_.push_back(0);
    const bool is_loaded = ImGui::GetIO().Fonts->TexID != nullptr;
    if (is_loaded) ImGui_ImplOpenGL3_DestroyFontsTexture();
    load_fonts();
    if (is_loaded) ImGui_ImplOpenGL3_CreateFontsTexture();
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
    const auto set = [&](ImGuiCol which, ImU32 colour) { style.Colors[which] = ImGui::ColorConvertU32ToFloat4(colour); };
    set(ImGuiCol_Text, ink);
    set(ImGuiCol_TextDisabled, faint_ink);
    set(ImGuiCol_WindowBg, panel);
    set(ImGuiCol_PopupBg, field);
    set(ImGuiCol_FrameBg, field);
    set(ImGuiCol_Border, border);
    set(ImGuiCol_Button, button);
    set(ImGuiCol_ButtonHovered, hovered_button);
    set(ImGuiCol_ButtonActive, pressed_button);
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

void draw_caption(ImDrawList* list, ImFont* font, ImVec2 place, ImU32 colour, const std::string& text)
{
    const ImVec2 size = font->CalcTextSizeA(font->FontSize, FLT_MAX, 0.0f, text.c_str());
    const float margin = 0.35f * font->FontSize, left = place.x - 0.5f * size.x;
    list->AddRectFilled({ left - margin, place.y }, { left + size.x + margin, place.y + size.y }, panel, margin);
    draw_text(list, font, place, { 0.5f, 0.0f }, colour, text);
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
