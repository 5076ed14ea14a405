/* What Embree 4 does otherwise than Embree 3: arguments that may be null and bring filters and functions, hits with an instance primitive,
   a mask of 1. Prints the same text with Embree 4.4 itself. The wheel that brings it has no headers: what is used is declared here.
   Build: cc program4.c PATH/libembree4.so.4 -lm */

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

typedef struct Device* RTCDevice;
typedef struct Scene* RTCScene;
typedef struct Geometry* RTCGeometry;
struct Ray { float org[3], tnear, dir[3], time, tfar; unsigned mask, id, flags; } __attribute__((aligned(16)));
struct Hit { float normal[3], u, v; unsigned primitive, geometry, instance, instance_primitive; } __attribute__((aligned(16)));
struct RayHit { struct Ray ray; struct Hit hit; };
struct Context { unsigned instance, instance_primitive; };
struct FilterArguments { int* valid; void* user; struct Context* context; struct Ray* ray; struct Hit* hit; unsigned n; };
struct BoundsArguments { void* user; unsigned primitive, step; float* bounds; };
struct UserArguments { int* valid; void* user; unsigned primitive; struct Context* context; struct RayHit* ray; unsigned n, geometry; };
struct Arguments {
  unsigned flags, features;
  struct Context* context;
  void (*filter)(const struct FilterArguments*);
  void (*function)(const struct UserArguments*);
  float least_width;
};

RTCDevice rtcNewDevice(const char*);
void rtcReleaseDevice(RTCDevice);
int rtcGetDeviceError(RTCDevice);
RTCScene rtcNewScene(RTCDevice);
void rtcReleaseScene(RTCScene);
void rtcSetSceneFlags(RTCScene, int);
void rtcCommitScene(RTCScene);
RTCGeometry rtcNewGeometry(RTCDevice, int);
void rtcReleaseGeometry(RTCGeometry);
void rtcCommitGeometry(RTCGeometry);
unsigned rtcAttachGeometry(RTCScene, RTCGeometry);
void* rtcSetNewGeometryBuffer(RTCGeometry, int, unsigned, int, size_t, size_t);
void rtcSetGeometryMask(RTCGeometry, unsigned);
void rtcSetGeometryUserData(RTCGeometry, void*);
void* rtcGetGeometryUserDataFromScene(RTCScene, unsigned);
void rtcSetGeometryEnableFilterFunctionFromArguments(RTCGeometry, bool);
void rtcSetGeometryUserPrimitiveCount(RTCGeometry, unsigned);
void rtcSetGeometryBoundsFunction(RTCGeometry, void (*)(const struct BoundsArguments*), void*);
void rtcSetGeometryInstancedScene(RTCGeometry, RTCScene);
void rtcSetGeometryTransform(RTCGeometry, unsigned, int, const void*);
void rtcIntersect1(RTCScene, struct RayHit*, struct Arguments*);
void rtcOccluded1(RTCScene, struct Ray*, struct Arguments*);
void rtcIntersect4(const int*, RTCScene, void*, struct Arguments*);

enum { FILTER_IN_ARGUMENTS = 8, INVOKE_FILTER = 2, USER = 120, INSTANCE = 121, FLOAT3 = 0x9003, UINT3 = 0x5003, COLUMNS = 0x9234 };

static void shoot(const char* what, RTCScene scene, float x, float y, unsigned mask, struct Arguments* arguments)
{
  struct RayHit r = { { { x, y, 5 }, 0, { 0, 0, -1 }, 0, INFINITY, mask, 0, 0 }, { { 0, 0, 0 }, 0, 0, -1, -1, -1, -1 } };
  struct Ray shadow = r.ray;
  rtcIntersect1(scene, &r, arguments);
  rtcOccluded1(scene, &shadow, arguments);
  printf("%s: tfar %.4f, %.4f geometry %d primitive %d instance %d %d u %.3f v %.3f\n", what, r.ray.tfar, shadow.tfar,
         (int)r.hit.geometry, (int)r.hit.primitive, (int)r.hit.instance, (int)r.hit.instance_primitive, r.hit.u, r.hit.v);
}

static RTCGeometry triangle(RTCDevice device, float z)
{
  RTCGeometry geometry = rtcNewGeometry(device, 0);
  const float corners[9] = { 0, 0, z, 1, 0, z, 0, 1, z };
  const unsigned indices[3] = { 0, 1, 2 };
  memcpy(rtcSetNewGeometryBuffer(geometry, 1, 0, FLOAT3, 12, 3), corners, sizeof corners);
  memcpy(rtcSetNewGeometryBuffer(geometry, 0, 0, UINT3, 12, 1), indices, sizeof indices);
  return geometry;
}

static unsigned attach(RTCScene scene, RTCGeometry geometry)
{
  rtcCommitGeometry(geometry);
  unsigned id = rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  return id;
}

static void refuse_first(const struct FilterArguments* a)
{
  if (a->hit->geometry == 0) a->valid[0] = 0;
}

static void unit_bounds(const struct BoundsArguments* a)
{
  const float box[8] = { 4, 0, 0, 0, 5, 1, 0, 0 };
  memcpy(a->bounds, box, sizeof box);
}

/* The square 4..5 x 0..1 at height 0, seen from above. */
static void unit_square(const struct UserArguments* a)
{
  struct Ray* r = &a->ray->ray;
  float t = -r->org[2] / r->dir[2];
  if (t <= r->tnear || t > r->tfar) return;
  r->tfar = t;
  a->ray->hit.geometry = a->geometry;
  a->ray->hit.primitive = a->primitive;
  a->ray->hit.instance = a->context->instance;
  a->ray->hit.instance_primitive = a->context->instance_primitive;
}

int main(void)
{
  RTCDevice device = rtcNewDevice("threads=1");
  if (!device) return 1;
  int data = 7;
  RTCScene scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, FILTER_IN_ARGUMENTS);
  RTCGeometry top = triangle(device, 2), low = triangle(device, 0);
  rtcSetGeometryUserData(top, &data);
  attach(scene, top);
  attach(scene, low);
  rtcCommitScene(scene);
  printf("user data %d\n", *(int*)rtcGetGeometryUserDataFromScene(scene, 0));
  struct Context context = { -1, -1 };
  struct Arguments arguments = { 0, -1, &context, refuse_first, NULL, 0 };
  shoot("without arguments", scene, 0.25f, 0.5f, -1, NULL);
  shoot("filter that nobody enabled", scene, 0.25f, 0.5f, -1, &arguments);
  arguments.flags = INVOKE_FILTER;
  shoot("filter for all", scene, 0.25f, 0.5f, -1, &arguments);
  arguments.flags = 0;
  rtcSetGeometryEnableFilterFunctionFromArguments(top, true);
  rtcCommitGeometry(top);
  rtcCommitScene(scene);
  shoot("filter for one", scene, 0.25f, 0.5f, -1, &arguments);

  RTCScene masked = rtcNewScene(device);
  RTCGeometry special = triangle(device, 1);
  rtcSetGeometryMask(special, 6);
  attach(masked, special);
  attach(masked, triangle(device, 0));
  RTCGeometry instance = rtcNewGeometry(device, INSTANCE);
  const float moved[12] = { 1, 0, 0, 0, 1, 0, 0, 0, 1, 2, 0, 1 };
  rtcSetGeometryInstancedScene(instance, scene);
  rtcSetGeometryTransform(instance, 0, COLUMNS, moved);
  attach(masked, instance);
  rtcCommitScene(masked);
  shoot("every mask", masked, 0.25f, 0.25f, -1, NULL);
  shoot("mask 1", masked, 0.25f, 0.25f, 1, NULL);
  shoot("mask 2", masked, 0.25f, 0.25f, 2, NULL);
  shoot("mask 8", masked, 0.25f, 0.25f, 8, NULL);
  shoot("instance", masked, 2.25f, 0.25f, 1, NULL);
  shoot("instance's mask", masked, 2.25f, 0.25f, 2, NULL);

  RTCScene squares = rtcNewScene(device);
  RTCGeometry user = rtcNewGeometry(device, USER);
  rtcSetGeometryUserPrimitiveCount(user, 1);
  rtcSetGeometryBoundsFunction(user, unit_bounds, NULL);
  attach(squares, user);
  rtcCommitScene(squares);
  arguments.filter = NULL;
  arguments.function = unit_square;
  struct RayHit r = { { { 4.5f, 0.5f, 5 }, 0, { 0, 0, -1 }, 0, INFINITY, -1, 0, 0 }, { { 0, 0, 0 }, 0, 0, -1, -1, -1, -1 } };
  rtcIntersect1(squares, &r, &arguments);
  printf("function of the arguments: tfar %.4f geometry %d instance %d\n", r.ray.tfar, (int)r.hit.geometry, (int)r.hit.instance);

  /* Field by field: 12 of a ray and 9 of a hit. */
  float packet[21][4] __attribute__((aligned(16)));
  memset(packet, 0, sizeof packet);
  const int valid[4] __attribute__((aligned(16))) = { -1, -1, 0, -1 }, none = -1;
  for (int i = 0; i < 4; i++) {
    packet[0][i] = 0.3f * (float)i;
    packet[1][i] = 0.25f;
    packet[2][i] = 5;
    packet[6][i] = -1;
    packet[8][i] = INFINITY;
    for (int field = 9; field < 21; field++) if (field == 9 || field > 16) memcpy(&packet[field][i], &none, 4);
  }
  rtcIntersect4(valid, scene, packet, NULL);
  for (int i = 0; i < 4; i++) {
    int ids[4];
    for (int k = 0; k < 4; k++) memcpy(&ids[k], &packet[17 + k][i], 4);
    printf("lane %d: tfar %.3f primitive %d geometry %d instance %d %d\n", i, packet[8][i], ids[0], ids[1], ids[2], ids[3]);
  }
  printf("error %d\n", rtcGetDeviceError(device));
  rtcReleaseScene(squares);
  rtcReleaseScene(masked);
  rtcReleaseScene(scene);
  rtcReleaseDevice(device);
  return 0;
}
