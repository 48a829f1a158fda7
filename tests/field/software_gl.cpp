#include "field/software_gl.h"

#define GL_GLEXT_PROTOTYPES
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/gl.h>
#include <GL/glext.h>

#include <array>
#include <cstdlib>
#include <stdexcept>

namespace {

constexpr int kWidth = 64;  // points a row of the picture that they make

// The functions of OpenGL 3.3 that are used, asked of EGL so that nothing links to a libGL.
struct Functions {
  PFNGLCREATESHADERPROC create_shader;
  PFNGLSHADERSOURCEPROC shader_source;
  PFNGLCOMPILESHADERPROC compile_shader;
  PFNGLGETSHADERIVPROC get_shader;
  PFNGLGETSHADERINFOLOGPROC shader_log;
  PFNGLCREATEPROGRAMPROC create_program;
  PFNGLATTACHSHADERPROC attach_shader;
  PFNGLLINKPROGRAMPROC link_program;
  PFNGLGETPROGRAMIVPROC get_program;
  PFNGLUSEPROGRAMPROC use_program;
  PFNGLDELETEPROGRAMPROC delete_program;
  PFNGLDELETESHADERPROC delete_shader;
  PFNGLGENFRAMEBUFFERSPROC gen_framebuffers;
  PFNGLBINDFRAMEBUFFERPROC bind_framebuffer;
  PFNGLFRAMEBUFFERTEXTURE2DPROC framebuffer_texture;
  PFNGLGENVERTEXARRAYSPROC gen_vertex_arrays;
  PFNGLBINDVERTEXARRAYPROC bind_vertex_array;
  PFNGLACTIVETEXTUREPROC active_texture;
  void (*gen_textures)(GLsizei, GLuint*);
  void (*bind_texture)(GLenum, GLuint);
  void (*tex_image)(GLenum, GLint, GLint, GLsizei, GLsizei, GLint, GLenum, GLenum, const void*);
  void (*tex_parameter)(GLenum, GLenum, GLint);
  void (*viewport)(GLint, GLint, GLsizei, GLsizei);
  void (*draw_arrays)(GLenum, GLint, GLsizei);
  void (*read_pixels)(GLint, GLint, GLsizei, GLsizei, GLenum, GLenum, void*);
  const GLubyte* (*get_string)(GLenum);
};

template <class F>
void load(F& function, const char* name) {
  function = reinterpret_cast<F>(eglGetProcAddress(name));
  if (function == nullptr) throw std::runtime_error(std::string("no ") + name);
}

Functions load_all() {
  Functions f{};
  load(f.create_shader, "glCreateShader");
  load(f.shader_source, "glShaderSource");
  load(f.compile_shader, "glCompileShader");
  load(f.get_shader, "glGetShaderiv");
  load(f.shader_log, "glGetShaderInfoLog");
  load(f.create_program, "glCreateProgram");
  load(f.attach_shader, "glAttachShader");
  load(f.link_program, "glLinkProgram");
  load(f.get_program, "glGetProgramiv");
  load(f.use_program, "glUseProgram");
  load(f.delete_program, "glDeleteProgram");
  load(f.delete_shader, "glDeleteShader");
  load(f.gen_framebuffers, "glGenFramebuffers");
  load(f.bind_framebuffer, "glBindFramebuffer");
  load(f.framebuffer_texture, "glFramebufferTexture2D");
  load(f.gen_vertex_arrays, "glGenVertexArrays");
  load(f.bind_vertex_array, "glBindVertexArray");
  load(f.active_texture, "glActiveTexture");
  load(f.gen_textures, "glGenTextures");
  load(f.bind_texture, "glBindTexture");
  load(f.tex_image, "glTexImage2D");
  load(f.tex_parameter, "glTexParameteri");
  load(f.viewport, "glViewport");
  load(f.draw_arrays, "glDrawArrays");
  load(f.read_pixels, "glReadPixels");
  load(f.get_string, "glGetString");
  return f;
}

constexpr const char* kVertex =
    "#version 330\nvoid main() { gl_Position = vec4(gl_VertexID == 1 ? 3 : -1, gl_VertexID == 2 ? "
    "3 "
    ": -1, 0, 1); }\n";

class Egl : public SoftwareGl {
 public:
  explicit Egl(EGLDisplay display) : display_(display), gl_(load_all()) {
    GLuint names[2];
    gl_.gen_textures(2, names);
    points_ = names[0];
    values_ = names[1];
    GLuint frame = 0;
    gl_.gen_framebuffers(1, &frame);
    gl_.bind_framebuffer(GL_FRAMEBUFFER, frame);
    GLuint vertices = 0;
    gl_.gen_vertex_arrays(1, &vertices);
    gl_.bind_vertex_array(vertices);
  }
  ~Egl() override { eglTerminate(display_); }

  std::vector<float> run(const std::string& text, const std::string& name,
                         const std::vector<float>& points) override {
    const int rows = static_cast<int>(points.size() / 3 / kWidth);
    set_picture(points_, GL_RGB32F, GL_RGB, rows, points.data());
    set_picture(values_, GL_R32F, GL_RED, rows, nullptr);
    gl_.framebuffer_texture(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, values_, 0);
    gl_.bind_texture(GL_TEXTURE_2D, points_);
    const GLuint program = link("#version 330\nuniform sampler2D points;\nout float value;\n" +
                                text + "void main() { value = " + name +
                                "(texelFetch(points, ivec2(gl_FragCoord.xy), 0).xyz); }\n");
    gl_.use_program(program);
    gl_.viewport(0, 0, kWidth, rows);
    gl_.draw_arrays(GL_TRIANGLES, 0, 3);
    std::vector<float> out(points.size() / 3);
    gl_.read_pixels(0, 0, kWidth, rows, GL_RED, GL_FLOAT, out.data());
    gl_.use_program(0);
    gl_.delete_program(program);
    return out;
  }
  [[nodiscard]] std::string name() const override {
    return reinterpret_cast<const char*>(gl_.get_string(GL_RENDERER));
  }

 private:
  void set_picture(GLuint texture, GLint inner, GLenum format, int rows, const float* data) const {
    gl_.active_texture(GL_TEXTURE0);
    gl_.bind_texture(GL_TEXTURE_2D, texture);
    gl_.tex_parameter(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl_.tex_parameter(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    gl_.tex_image(GL_TEXTURE_2D, 0, inner, kWidth, rows, 0, format, GL_FLOAT, data);
  }
  [[nodiscard]] GLuint compiled(GLenum kind, const std::string& text) const {
    const GLuint shader = gl_.create_shader(kind);
    const char* lines = text.c_str();
    gl_.shader_source(shader, 1, &lines, nullptr);
    gl_.compile_shader(shader);
    GLint good = 0;
    gl_.get_shader(shader, GL_COMPILE_STATUS, &good);
    if (good != 0) return shader;
    std::array<char, 2000> log{};
    gl_.shader_log(shader, log.size(), nullptr, log.data());
    throw std::runtime_error(log.data());
  }
  [[nodiscard]] GLuint link(const std::string& fragment) const {
    const GLuint program = gl_.create_program();
    for (const GLuint shader :
         {compiled(GL_VERTEX_SHADER, kVertex), compiled(GL_FRAGMENT_SHADER, fragment)}) {
      gl_.attach_shader(program, shader);
      gl_.delete_shader(shader);  // with the program
    }
    gl_.link_program(program);
    GLint good = 0;
    gl_.get_program(program, GL_LINK_STATUS, &good);
    if (good == 0) throw std::runtime_error("the program does not link");
    return program;
  }

  EGLDisplay display_;
  Functions gl_;
  GLuint points_ = 0;
  GLuint values_ = 0;
};

// A context of OpenGL 3.3 without a surface.
bool make_current(EGLDisplay display) {
  constexpr EGLint kConfig[] = {EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
  constexpr EGLint kContext[] = {EGL_CONTEXT_MAJOR_VERSION,
                                 3,
                                 EGL_CONTEXT_MINOR_VERSION,
                                 3,
                                 EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                 EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                 EGL_NONE};
  EGLConfig config = nullptr;
  EGLint configs = 0;
  if (eglBindAPI(EGL_OPENGL_API) == EGL_FALSE) return false;
  if (eglChooseConfig(display, kConfig, &config, 1, &configs) == EGL_FALSE || configs == 0) {
    return false;
  }
  EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, kContext);
  return context != EGL_NO_CONTEXT &&
         eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) == EGL_TRUE;
}

}  // namespace

std::unique_ptr<SoftwareGl> SoftwareGl::start(std::string& why) {
  setenv("LIBGL_ALWAYS_SOFTWARE", "1", 1);
  why = "no EGL without a display (packages libegl-mesa0 and libgl1-mesa-dri)";
  EGLDisplay display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr);
  if (display == EGL_NO_DISPLAY || eglInitialize(display, nullptr, nullptr) == EGL_FALSE) return {};
  if (!make_current(display)) {
    eglTerminate(display);
    return {};
  }
  return std::make_unique<Egl>(display);
}
