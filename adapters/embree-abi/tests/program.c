/* A program for Embree 3 that uses everything the library supports and prints what it gets: the same text with Embree itself.
   Numbers are printed to four digits, so that rounding does not show. Build: cc program.c -lembree3 -lpthread -lm */

#include <embree3/rtcore.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int filter_calls;

static void on_error(void* user, enum RTCError code, const char* text)
{
  (void)text;
  printf("%s: error %d\n", (const char*)user, (int)code);
}

static struct RTCRayHit ray_hit(float x, float y, float z, float dx, float dy, float dz)
{
  struct RTCRayHit r;
  memset(&r, 0, sizeof r);
  r.ray.org_x = x; r.ray.org_y = y; r.ray.org_z = z;
  r.ray.dir_x = dx; r.ray.dir_y = dy; r.ray.dir_z = dz;
  r.ray.tfar = INFINITY;
  r.ray.mask = -1;
  r.hit.geomID = r.hit.primID = r.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  return r;
}

/* The first ray's fields: the headers have these for C++ only. */
static unsigned hit_primitive(struct RTCHitN* hit, unsigned n) { return ((unsigned*)hit)[5 * n]; }
static float ray_end(struct RTCRayN* ray, unsigned n) { return ((float*)ray)[8 * n]; }

static float round4(float v) { return fabsf(v) < 5e-5f ? 0.0f : v; }

static void print_hit(const char* what, const struct RTCRayHit* r)
{
  if (r->hit.geomID == RTC_INVALID_GEOMETRY_ID) { printf("%s: nothing, tfar %.4g\n", what, r->ray.tfar); return; }
  printf("%s: t %.4f geometry %u primitive %u instance %d u %.4f v %.4f normal %.4f %.4f %.4f\n", what, r->ray.tfar,
         r->hit.geomID, r->hit.primID, (int)r->hit.instID[0], round4(r->hit.u), round4(r->hit.v),
         round4(r->hit.Ng_x), round4(r->hit.Ng_y), round4(r->hit.Ng_z));
}

static void shoot_in(const char* what, RTCScene scene, struct RTCIntersectContext* context, struct RTCRayHit r)
{
  struct RTCRay shadow = r.ray;
  rtcIntersect1(scene, context, &r);
  print_hit(what, &r);
  rtcOccluded1(scene, context, &shadow);
  printf("%s: occluded %d\n", what, shadow.tfar == -INFINITY);
}

static void shoot(const char* what, RTCScene scene, struct RTCRayHit r)
{
  struct RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  shoot_in(what, scene, &context, r);
}

/* The square 0..1 x 0..1 at height z: two triangles or one quad. */
static RTCGeometry square(RTCDevice device, enum RTCGeometryType type, float z)
{
  RTCGeometry geometry = rtcNewGeometry(device, type);
  float* v = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, 4);
  const float corners[12] = { 0, 0, z, 1, 0, z, 1, 1, z, 0, 1, z };
  memcpy(v, corners, sizeof corners);
  if (type == RTC_GEOMETRY_TYPE_QUAD) {
    unsigned* i = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4, 16, 1);
    const unsigned quad[4] = { 0, 1, 2, 3 };
    memcpy(i, quad, sizeof quad);
  } else {
    unsigned* i = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, 2);
    const unsigned triangles[6] = { 0, 1, 2, 0, 2, 3 };
    memcpy(i, triangles, sizeof triangles);
  }
  return geometry;
}

static RTCScene scene_of(RTCDevice device, RTCGeometry geometry)
{
  RTCScene scene = rtcNewScene(device);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene);
  return scene;
}

static void triangles_and_quads(RTCDevice device)
{
  RTCScene scene = scene_of(device, square(device, RTC_GEOMETRY_TYPE_TRIANGLE, 0));
  shoot("first triangle", scene, ray_hit(0.75f, 0.25f, 2, 0, 0, -1));
  shoot("second triangle", scene, ray_hit(0.25f, 0.625f, 2, 0, 0, -2));
  shoot("past it", scene, ray_hit(1.5f, 0.25f, 2, 0, 0, -1));
  struct RTCRayHit r = ray_hit(0.75f, 0.25f, 2, 0, 0, -1);
  r.ray.tfar = 1.5f;
  shoot("too short", scene, r);
  r.ray.tnear = 2.5f; r.ray.tfar = 9;
  shoot("too late", scene, r);
  r.ray.tnear = 3; r.ray.tfar = 1;
  shoot("inactive", scene, r);
  shoot("from the surface", scene, ray_hit(0.75f, 0.25f, 0, 0, 0, -1));
  struct RTCBounds b;
  rtcGetSceneBounds(scene, &b);
  printf("bounds %.3f %.3f %.3f .. %.3f %.3f %.3f\n", b.lower_x, b.lower_y, b.lower_z, b.upper_x, b.upper_y, b.upper_z);
  rtcReleaseScene(scene);

  scene = scene_of(device, square(device, RTC_GEOMETRY_TYPE_QUAD, 1));
  shoot("quad, first half", scene, ray_hit(0.25f, 0.125f, 2, 0, 0, -1));
  shoot("quad, second half", scene, ray_hit(0.75f, 0.875f, 2, 0, 0, -1));
  rtcReleaseScene(scene);

  /* Shared buffers with wide strides, changed after a commit; indices that lead nowhere and vertices that are none. */
  float vertices[16] = { 0, 0, 0, 9, 1, 0, 0, 9, 0, 1, 0, 9, NAN, 0, 0, 9 };
  unsigned indices[12] = { 0, 1, 2, 77, 0, 1, 3, 77, 0, 1, 9, 77 };
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, vertices, 0, 16, 4);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, indices, 0, 16, 3);
  rtcRetainGeometry(geometry);
  scene = scene_of(device, geometry);
  shoot("shared", scene, ray_hit(0.25f, 0.25f, 2, 0, 0, -1));
  vertices[2] = vertices[6] = vertices[10] = -3;
  rtcUpdateGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0);
  rtcCommitGeometry(geometry);
  rtcCommitScene(scene);
  shoot("moved", scene, ray_hit(0.25f, 0.25f, 2, 0, 0, -1));
  float p[3], du[3], dv[3];
  rtcInterpolate1(geometry, 0, 0.25f, 0.5f, RTC_BUFFER_TYPE_VERTEX, 0, p, du, dv, 3);
  printf("between %.4f %.4f %.4f, %.4f %.4f %.4f, %.4f %.4f %.4f\n", p[0], p[1], p[2], du[0], du[1], du[2], dv[0], dv[1], dv[2]);
  rtcDisableGeometry(geometry);
  rtcCommitGeometry(geometry);
  rtcCommitScene(scene);
  shoot("disabled", scene, ray_hit(0.25f, 0.25f, 2, 0, 0, -1));
  rtcEnableGeometry(geometry);
  rtcCommitGeometry(geometry);
  rtcCommitScene(scene);
  shoot("enabled", scene, ray_hit(0.25f, 0.25f, 2, 0, 0, -1));
  rtcDetachGeometry(scene, 0);
  rtcCommitScene(scene);
  shoot("detached", scene, ray_hit(0.25f, 0.25f, 2, 0, 0, -1));
  rtcReleaseGeometry(geometry);
  rtcReleaseScene(scene);
}

/* Balls around (primID, 0, 0) of radius 1/4; the user data say how high. */
static void ball_bounds(const struct RTCBoundsFunctionArguments* a)
{
  float x = (float)a->primID, z = *(float*)a->geometryUserPtr;
  struct RTCBounds b = { x - 0.25f, -0.25f, z - 0.25f, 0, x + 0.25f, 0.25f, z + 0.25f, 0 };
  *a->bounds_o = b;
}

static float ball_at(const struct RTCRay* r, float x, float z)
{
  float ox = r->org_x - x, oy = r->org_y, oz = r->org_z - z;
  float a = r->dir_x * r->dir_x + r->dir_y * r->dir_y + r->dir_z * r->dir_z;
  float b = ox * r->dir_x + oy * r->dir_y + oz * r->dir_z;
  float c = ox * ox + oy * oy + oz * oz - 0.0625f;
  float d = b * b - a * c;
  if (d < 0) return INFINITY;
  float t = (-b - sqrtf(d)) / a;
  return t > r->tnear && t <= r->tfar ? t : INFINITY;
}

static void ball_intersect(const struct RTCIntersectFunctionNArguments* a)
{
  if (!a->valid[0]) return;
  struct RTCRayHit* r = (struct RTCRayHit*)a->rayhit;
  float t = ball_at(&r->ray, (float)a->primID, *(float*)a->geometryUserPtr);
  if (t == INFINITY) return;
  struct RTCHit hit;
  memset(&hit, 0, sizeof hit);
  hit.geomID = a->geomID; hit.primID = a->primID; hit.instID[0] = a->context->instID[0];
  hit.Ng_z = 1; hit.u = 0.5f;
  float before = r->ray.tfar;
  r->ray.tfar = t;
  int valid = -1;
  struct RTCFilterFunctionNArguments f = { &valid, a->geometryUserPtr, a->context, (struct RTCRayN*)r, (struct RTCHitN*)&hit, 1 };
  rtcFilterIntersection(a, &f);
  if (valid) r->hit = hit; else r->ray.tfar = before;
}

static void ball_occluded(const struct RTCOccludedFunctionNArguments* a)
{
  struct RTCRay* r = (struct RTCRay*)a->ray;
  if (a->valid[0] && ball_at(r, (float)a->primID, *(float*)a->geometryUserPtr) < INFINITY) r->tfar = -INFINITY;
}

/* Refuses the first of the balls. */
static void not_the_first(const struct RTCFilterFunctionNArguments* a)
{
  filter_calls++;
  if (hit_primitive(a->hit, a->N) == 0) a->valid[0] = 0;
}

static RTCGeometry balls(RTCDevice device, float* height, unsigned count)
{
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, count);
  rtcSetGeometryUserData(geometry, height);
  rtcSetGeometryBoundsFunction(geometry, ball_bounds, NULL);
  rtcSetGeometryIntersectFunction(geometry, ball_intersect);
  rtcSetGeometryOccludedFunction(geometry, ball_occluded);
  return geometry;
}

static void user_geometries_and_instances(RTCDevice device)
{
  float height = 1;
  RTCScene inner = rtcNewScene(device);
  RTCGeometry floor = square(device, RTC_GEOMETRY_TYPE_QUAD, 0), geometry = balls(device, &height, 3);
  rtcSetGeometryIntersectFilterFunction(geometry, not_the_first);
  rtcCommitGeometry(floor);
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(inner, geometry, 7);
  printf("floor is geometry %u\n", rtcAttachGeometry(inner, floor));
  printf("user data %d\n", rtcGetGeometryUserData(rtcGetGeometry(inner, 7)) == &height);
  rtcReleaseGeometry(floor);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(inner);
  shoot("ball", inner, ray_hit(1, 0.0625f, 5, 0, 0, -1));
  shoot("refused ball, floor", inner, ray_hit(0.125f, 0.125f, 5, 0, 0, -1));

  /* Twice as large and moved, and once mirrored. */
  RTCScene outer = rtcNewScene(device);
  const float transforms[2][12] = { { 2, 0, 0, 0, 2, 0, 0, 0, 2, 10, 0, 0 }, { -1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 5, -0.5f } };
  for (int i = 0; i < 2; i++) {
    RTCGeometry instance = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(instance, inner);
    rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, transforms[i]);
    rtcCommitGeometry(instance);
    rtcAttachGeometry(outer, instance);
    rtcReleaseGeometry(instance);
  }
  RTCGeometry turned = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
  struct RTCQuaternionDecomposition q;
  rtcInitQuaternionDecomposition(&q);
  rtcQuaternionDecompositionSetQuaternion(&q, 0.5f, 0.5f, 0.5f, 0.5f);
  rtcQuaternionDecompositionSetScale(&q, 1, 2, 3);
  rtcQuaternionDecompositionSetSkew(&q, 0.5f, 0.25f, 0.125f);
  rtcQuaternionDecompositionSetShift(&q, 1, 2, 4);
  rtcQuaternionDecompositionSetTranslation(&q, 0, 20, 0);
  rtcSetGeometryInstancedScene(turned, inner);
  rtcSetGeometryTransformQuaternion(turned, 0, &q);
  rtcCommitGeometry(turned);
  rtcAttachGeometry(outer, turned);
  float m[16];
  rtcGetGeometryTransform(turned, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, m);
  for (int i = 0; i < 16; i++) printf("%.3f%c", round4(m[i]), i % 4 == 3 ? '\n' : ' ');
  rtcReleaseGeometry(turned);
  rtcReleaseScene(inner);
  rtcCommitScene(outer);
  shoot("ball in the first instance", outer, ray_hit(12, 0.125f, 9, 0, 0, -1));
  shoot("refused ball in the first instance", outer, ray_hit(10.25f, 0.25f, 9, 0, 0, -1));
  shoot("ball in the second instance", outer, ray_hit(-1, 5.0625f, 9, 0, 0, -1));
  shoot("floor of the second instance", outer, ray_hit(-0.25f, 5.75f, 9, 0, 0, -1));
  rtcReleaseScene(outer);
}

/* Refuses what the user data point to. */
static void refuse(const struct RTCFilterFunctionNArguments* a)
{
  filter_calls++;
  if (a->valid[0] && hit_primitive(a->hit, a->N) == *(unsigned*)a->geometryUserPtr) a->valid[0] = 0;
}

/* Refuses everything nearer than 3, seen through the ray, which ends at the hit. */
static void refuse_near(const struct RTCFilterFunctionNArguments* a)
{
  if (ray_end(a->ray, a->N) < 3) a->valid[0] = 0;
}

static void filters_and_masks(RTCDevice device)
{
  unsigned refused = 0;
  RTCScene scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
  RTCGeometry top = square(device, RTC_GEOMETRY_TYPE_TRIANGLE, 2), low = square(device, RTC_GEOMETRY_TYPE_TRIANGLE, 0);
  rtcSetGeometryUserData(top, &refused);
  rtcSetGeometryIntersectFilterFunction(top, refuse);
  rtcSetGeometryOccludedFilterFunction(top, refuse);
  rtcSetGeometryMask(low, 6);
  rtcCommitGeometry(top);
  rtcCommitGeometry(low);
  rtcAttachGeometry(scene, top);
  rtcAttachGeometry(scene, low);
  rtcReleaseGeometry(top);
  rtcReleaseGeometry(low);
  rtcCommitScene(scene);
  shoot("refused, then the lower one", scene, ray_hit(0.75f, 0.25f, 4, 0, 0, -1));
  shoot("accepted", scene, ray_hit(0.25f, 0.625f, 4, 0, 0, -1));
  struct RTCRayHit r = ray_hit(0.75f, 0.25f, 4, 0, 0, -1);
  r.ray.mask = 1;
  shoot("masked", scene, r);
  r.ray.mask = 2;
  shoot("seen through its mask", scene, r);
  struct RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.filter = refuse_near;
  shoot_in("context's filter", scene, &context, ray_hit(0.25f, 0.625f, 4, 0, 0, -1));
  rtcReleaseScene(scene);
}

static void many_rays(RTCDevice device)
{
  RTCScene scene = scene_of(device, square(device, RTC_GEOMETRY_TYPE_TRIANGLE, 0));
  struct RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  struct RTCRayHit one[16], *pointers[16];
  struct RTCRayHit16 packet;
  memset(&packet, 0, sizeof packet);
  int valid[16] __attribute__((aligned(64)));
  for (int i = 0; i < 16; i++) {
    one[i] = ray_hit(0.1f * (float)i, 0.3f, 1, 0, 0, -1);
    pointers[i] = &one[i];
    valid[i] = i == 3 ? 0 : -1;
    packet.ray.org_x[i] = one[i].ray.org_x; packet.ray.org_y[i] = 0.3f; packet.ray.org_z[i] = 1;
    packet.ray.dir_z[i] = -1; packet.ray.tfar[i] = INFINITY; packet.ray.mask[i] = -1;
    packet.hit.geomID[i] = packet.hit.primID[i] = packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
  }
  struct RTCRay16 shadow = packet.ray;
  rtcIntersect16(valid, scene, &context, &packet);
  rtcOccluded16(valid, scene, &context, &shadow);
  for (int i = 0; i < 16; i++)
    printf("lane %d: primitive %d u %.3f v %.3f tfar %.3g, %.3g\n", i, (int)packet.hit.primID[i], round4(packet.hit.u[i]), round4(packet.hit.v[i]),
           packet.ray.tfar[i], shadow.tfar[i]);
  rtcIntersect1M(scene, &context, one, 8, sizeof one[0]);
  rtcIntersect1Mp(scene, &context, pointers + 8, 8);
  int wrong = 0;
  for (int i = 0; i < 16; i++) wrong += valid[i] && one[i].hit.primID != packet.hit.primID[i];
  printf("streams differ from the packet in %d rays\n", wrong);
  rtcReleaseScene(scene);
}

static void* join(void* scene)
{
  rtcJoinCommitScene((RTCScene)scene);
  struct RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  struct RTCRayHit r = ray_hit(0.75f, 0.25f, 2, 0, 0, -1);
  rtcIntersect1((RTCScene)scene, &context, &r);
  return (void*)(size_t)(r.hit.primID + 1);
}

static void threads(RTCDevice device)
{
  RTCScene scene = rtcNewScene(device);
  RTCGeometry geometry = square(device, RTC_GEOMETRY_TYPE_TRIANGLE, 0);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  pthread_t all[4];
  size_t sum = 0;
  for (int i = 0; i < 4; i++) pthread_create(&all[i], NULL, join, scene);
  for (int i = 0; i < 4; i++) {
    void* found;
    pthread_join(all[i], &found);
    sum += (size_t)found;
  }
  printf("threads found %d\n", (int)sum);
  rtcReleaseScene(scene);
}

static ssize_t bytes;

static bool count_bytes(void* user, ssize_t change, bool post)
{
  (void)user; (void)post;
  __atomic_add_fetch(&bytes, change, __ATOMIC_RELAXED);
  return true;
}

static bool progress(void* user, double share)
{
  *(int*)user += share >= 0 && share <= 1;
  return true;
}

static bool cancel(void* user, double share)
{
  (void)user; (void)share;
  return false;
}

/* A mesh of 2 n^2 triangles, so that there is something to build. */
static RTCGeometry terrain(RTCDevice device, unsigned n)
{
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  float* v = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, (n + 1) * (n + 1));
  unsigned* t = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, 2 * n * n);
  for (unsigned y = 0; y <= n; y++)
    for (unsigned x = 0; x <= n; x++, v += 3) { v[0] = (float)x; v[1] = (float)y; v[2] = (float)((x * 7 + y * 5) % 4); }
  for (unsigned y = 0; y < n; y++)
    for (unsigned x = 0; x < n; x++, t += 6) {
      unsigned a = y * (n + 1) + x;
      const unsigned two[6] = { a, a + 1, a + n + 1, a + 1, a + n + 2, a + n + 1 };
      memcpy(t, two, sizeof two);
    }
  return geometry;
}

static void monitors(RTCDevice device)
{
  int calls = 0;
  rtcSetDeviceMemoryMonitorFunction(device, count_bytes, NULL);
  RTCScene scene = rtcNewScene(device);
  RTCGeometry geometry = terrain(device, 64);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcSetSceneProgressMonitorFunction(scene, progress, &calls);
  rtcCommitScene(scene);
  printf("progress was told %d, memory counted %d\n", calls > 0, bytes > 0);
  shoot("terrain", scene, ray_hit(30.3f, 20.4f, 9, 0.01f, 0.02f, -1));
  rtcReleaseScene(scene);
  printf("bytes left %d\n", (int)bytes);
  rtcSetDeviceMemoryMonitorFunction(device, NULL, NULL);

  scene = rtcNewScene(device);
  geometry = terrain(device, 64);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcSetSceneProgressMonitorFunction(scene, cancel, NULL);
  rtcCommitScene(scene);
  printf("error kept for the thread %d, then %d\n", (int)rtcGetDeviceError(device), (int)rtcGetDeviceError(device));
  rtcReleaseScene(scene);
}

static void errors(RTCDevice device)
{
  RTCScene scene = rtcNewScene(device);
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  float v[4] = { 0, 0, 0, 0 };
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT2, v, 0, 12, 1);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, v, 0, 13, 1);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4, v, 0, 16, 1);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 1, RTC_FORMAT_FLOAT3, v, 0, 12, 1);
  rtcSetGeometryInstancedScene(geometry, scene);
  rtcSetGeometryUserPrimitiveCount(geometry, 1);
  rtcDetachGeometry(scene, 5);
  printf("kept %d\n", (int)rtcGetDeviceError(device));
  RTCBuffer buffer = rtcNewBuffer(device, 36);
  rtcSetGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, buffer, 0, 12, 3);
  printf("buffer %d\n", rtcGetGeometryBufferData(geometry, RTC_BUFFER_TYPE_VERTEX, 0) == rtcGetBufferData(buffer));
  rtcReleaseBuffer(buffer);
  rtcReleaseGeometry(geometry);
  rtcReleaseScene(scene);
  rtcReleaseScene(NULL);
  printf("without a device %d\n", (int)rtcGetDeviceError(NULL));
}

int main(void)
{
  RTCDevice device = rtcNewDevice("threads=2");
  printf("device %d\n", device != NULL);
  if (!device) return 1;
  rtcSetDeviceErrorFunction(device, on_error, (void*)"device");
  RTCScene empty = rtcNewScene(device);
  rtcCommitScene(empty);
  shoot("empty", empty, ray_hit(0, 0, 1, 0, 0, -1));
  rtcReleaseScene(empty);
  triangles_and_quads(device);
  user_geometries_and_instances(device);
  filters_and_masks(device);
  many_rays(device);
  threads(device);
  monitors(device);
  errors(device);
  printf("filters were called %d\n", filter_calls > 0);
  rtcRetainDevice(device);
  rtcReleaseDevice(device);
  rtcReleaseDevice(device);
  return 0;
}
