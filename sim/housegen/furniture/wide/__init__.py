"""Styles that no split shows: houses of the pool `wide` have them beside train's, to train perception on more shapes.

They were designed without a look at the held-out ones, which stay what a network has never seen.

Sizes follow, as train's, Neufert, Architects' Data, Panero & Zelnik, Human Dimension and Interior Space, the European
kitchen grid (EN 1116), usual mattress sizes (EN 1334) and retail ranges, but with a wider spread.
"""
