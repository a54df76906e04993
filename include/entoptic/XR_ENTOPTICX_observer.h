/* XR_ENTOPTICX_observer: the person who looks: where each eye points, how wide its pupil is, what it is adapted to, and how all that is known.
 *
 * Experimental. Public C header of an OpenXR extension of the Entoptic runtime. docs/extensions/XR_ENTOPTICX_observer.md specifies it.
 */
#ifndef XR_ENTOPTICX_OBSERVER_H_
#define XR_ENTOPTICX_OBSERVER_H_ 1

#include <openxr/openxr.h>

#ifdef __cplusplus
extern "C" {
#endif

#define XR_ENTOPTICX_observer 1
#define XR_ENTOPTICX_observer_SPEC_VERSION 2
#define XR_ENTOPTICX_OBSERVER_EXTENSION_NAME "XR_ENTOPTICX_observer"

/* Structure types. The numbers lie outside of the ranges that Khronos has given to registered extensions. */
#define XR_TYPE_OBSERVER_GET_INFO_ENTOPTICX ((XrStructureType)1000987010)
#define XR_TYPE_OBSERVER_ENTOPTICX ((XrStructureType)1000987011)
#define XR_TYPE_OBSERVER_DETAIL_ENTOPTICX ((XrStructureType)1000987012)  /* since revision 2 */

/* How a value is known. */
typedef enum XrObserverProvenanceENTOPTICX {
    XR_OBSERVER_PROVENANCE_ABSENT_ENTOPTICX = 0,   /* not known: the value is a fixed fallback */
    XR_OBSERVER_PROVENANCE_MODELLED_ENTOPTICX = 1, /* computed by a model, or held after the tracker lost the eye */
    XR_OBSERVER_PROVENANCE_MEASURED_ENTOPTICX = 2, /* from the tracker's samples, filtered and predicted to `time` */
    XR_OBSERVER_PROVENANCE_MAX_ENUM_ENTOPTICX = 0x7FFFFFFF
} XrObserverProvenanceENTOPTICX;

/* What a tracker itself reported last about an eye, before any filter. Its numbers may be anything, also NaN. */
typedef struct XrObserverRawSampleENTOPTICX {
    XrBool32 isAvailable;      /* XR_FALSE: no sample has arrived; the other members are 0 */
    XrTime exposureTime;       /* when the light of the sample fell on the tracker's sensor */
    XrTime arrivalTime;        /* when the runtime had it */
    XrVector3f gazeDirection;  /* in VIEW space, as reported */
    float pupilDiameter;       /* mm, as reported */
    float confidence;          /* as reported */
} XrObserverRawSampleENTOPTICX;

typedef struct XrObserverEyeENTOPTICX {
    XrVector3f gazeOrigin;     /* centre of the eye, in the base space, metres */
    XrVector3f gazeDirection;  /* unit vector in the base space */
    XrObserverProvenanceENTOPTICX gazeProvenance;
    float pupilDiameter;       /* of the entrance pupil, mm */
    XrObserverProvenanceENTOPTICX pupilProvenance;
    float eyelidOpening;       /* 0 closed, 1 open */
    float confidence;          /* 0..1, of the sample that was used */
    XrTime sampleTime;         /* when the light of that sample fell on the tracker's sensor; 0: unknown */
    XrBool32 isAdaptationKnown;
    float adaptationLuminance; /* cd/m2 that the simulated eye is adapted to, at the last frame shown; 0 when not known */
    XrObserverRawSampleENTOPTICX raw;
} XrObserverEyeENTOPTICX;

typedef struct XrObserverGetInfoENTOPTICX {
    XrStructureType type;
    const void* XR_MAY_ALIAS next;
    XrSpace baseSpace;
    XrTime time;               /* what the gaze and the pupil are an estimate for */
} XrObserverGetInfoENTOPTICX;

typedef struct XrObserverENTOPTICX {
    XrStructureType type;
    void* XR_MAY_ALIAS next;
    XrSpaceLocationFlags headLocationFlags;  /* of VIEW in the base space: without valid bits the gaze's origin and direction are VIEW's */
    XrVector3f combinedGazeDirection;        /* of both eyes together, unit vector in the base space */
    XrObserverEyeENTOPTICX eyes[2];          /* left, right */
} XrObserverENTOPTICX;

/* Chained to XrObserverENTOPTICX: which detail the observer can see, so that an application need not draw more. Since revision 2. */
typedef struct XrObserverDetailENTOPTICX {
    XrStructureType type;
    void* XR_MAY_ALIAS next;
    float resolvedAngle[2];    /* left, right: half a period of the finest grating resolved where the eye looks, rad */
    float eccentricityFactor;  /* 1/rad: at an angle e (rad) from the gaze it is resolvedAngle * (1 + eccentricityFactor * e) */
    float focusVergence;       /* 1/m: where the eyes' axes meet, 0 at infinity; negative: not known */
} XrObserverDetailENTOPTICX;

typedef XrResult(XRAPI_PTR* PFN_xrGetObserverENTOPTICX)(XrSession session, const XrObserverGetInfoENTOPTICX* getInfo,
                                                        XrObserverENTOPTICX* observer);

#ifdef __cplusplus
}
#endif

#endif /* XR_ENTOPTICX_OBSERVER_H_ */
