"""Training and evaluation of the segmentation networks on labelled views."""
