"""Teamformer: decentralised team formation for heterogeneous multi-robot teams."""
