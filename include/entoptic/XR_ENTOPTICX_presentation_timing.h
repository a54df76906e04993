/* XR_ENTOPTICX_presentation_timing: when the light of each frame left the panel, and whether it was shown once, again, or never.
 *
 * Experimental. Public C header of an OpenXR extension of the Entoptic runtime. docs/extensions/XR_ENTOPTICX_presentation_timing.md
 * specifies it.
 */
#ifndef XR_ENTOPTICX_PRESENTATION_TIMING_H_
#define XR_ENTOPTICX_PRESENTATION_TIMING_H_ 1

#include <openxr/openxr.h>

#ifdef __cplusplus
extern "C" {
#endif

#define XR_ENTOPTICX_presentation_timing 1
#define XR_ENTOPTICX_presentation_timing_SPEC_VERSION 1
#define XR_ENTOPTICX_PRESENTATION_TIMING_EXTENSION_NAME "XR_ENTOPTICX_presentation_timing"

/* Structure types. The numbers lie outside of the ranges that Khronos has given to registered extensions. */
#define XR_TYPE_PRESENTATION_TIMING_GET_INFO_ENTOPTICX ((XrStructureType)1000987020)

/* Frames that the runtime remembers at least. */
#define XR_ENTOPTICX_PRESENTATION_TIMING_HISTORY 1024

typedef enum XrPresentationStatusENTOPTICX {
    XR_PRESENTATION_STATUS_PENDING_ENTOPTICX = 0,  /* may still be shown */
    XR_PRESENTATION_STATUS_SHOWN_ENTOPTICX = 1,    /* its light left the panel; refreshesShown may still grow while it is the newest */
    XR_PRESENTATION_STATUS_NEVER_ENTOPTICX = 2,    /* not submitted, or a newer frame was shown in its place */
    XR_PRESENTATION_STATUS_MAX_ENUM_ENTOPTICX = 0x7FFFFFFF
} XrPresentationStatusENTOPTICX;

typedef struct XrPresentationTimingENTOPTICX {
    XrTime predictedDisplayTime;  /* of the XrFrameState that xrWaitFrame gave: names the frame */
    XrTime submittedTime;         /* when xrEndFrame had been called and the GPU had finished; 0: never */
    XrTime displayTime;           /* middle of its first light; 0: none yet */
    uint32_t refreshesShown;      /* display refreshes that showed it: 1 once, more: again, reprojected or held */
    XrPresentationStatusENTOPTICX status;
} XrPresentationTimingENTOPTICX;

typedef struct XrPresentationTimingGetInfoENTOPTICX {
    XrStructureType type;
    const void* XR_MAY_ALIAS next;
    XrTime after;                 /* only frames whose predictedDisplayTime is later; 0: all that are remembered */
} XrPresentationTimingGetInfoENTOPTICX;

/* Oldest first; the two-call idiom of OpenXR. */
typedef XrResult(XRAPI_PTR* PFN_xrEnumeratePresentationTimingsENTOPTICX)(XrSession session,
                                                                         const XrPresentationTimingGetInfoENTOPTICX* getInfo,
                                                                         uint32_t timingCapacityInput, uint32_t* timingCountOutput,
                                                                         XrPresentationTimingENTOPTICX* timings);

#ifdef __cplusplus
}
#endif

#endif /* XR_ENTOPTICX_PRESENTATION_TIMING_H_ */
