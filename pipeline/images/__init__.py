"""Photographs of the objects: files, URLs and IIIF to small pictures.  The only package that knows Pillow."""
