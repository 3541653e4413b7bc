"""The page on which a segmentation is looked at, corrected and delivered, and its server."""
